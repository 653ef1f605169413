// SPDX-License-Identifier: BSD-3-Clause
// What effects there are, and what their names mean.
#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "sepcal/detail/flight/effect_catalogue.hpp"
#include "sepcal/effect_name.hpp"
#include "sepcal/flight/probe.hpp"
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

/// The channels that effects name as their drivers.
std::vector<std::string> channels(const std::vector<std::string>& texts) {
  std::vector<std::string> bases;
  for (const std::string& text : texts) {
    for (const std::string& name : split_effects(text)) {
      bases.push_back(parse_effect_name(name).base);
    }
  }
  std::erase(bases, "");
  return bases;
}

}  // namespace

void define_effects(py::module_& module) {
  BoundStruct<CataloguedEffect>(module, "CataloguedEffect",
                                "An effect that fit(..., effects=[name]) adds to a probe's model.")
      .field("name", &CataloguedEffect::name,
             "`port[driver]`, or a name of its own; DRIVER stands for any.")
      .field("equation", &CataloguedEffect::equation, "The equation that joins the model.")
      .field("drivers", &CataloguedEffect::drivers, "The columns that it needs.")
      .field("unit", &CataloguedEffect::unit, "Unit of its coefficient.")
      .comparable()
      .finish();
  module.def("effects", [](const std::string& probe) {
    const auto catalogue = effect_catalogue(probe);
    return std::vector(catalogue.begin(), catalogue.end());
  });
  module.def("channels", &channels);
  // Names of those that ship, in their order, and what people call them.
  module.def("shipped_probes", [] {
    std::vector<std::pair<std::string, std::string>> names;
    for (ShippedName& each : shipped_probes()) {
      names.emplace_back(std::move(each.name), std::move(each.words));
    }
    return names;
  });
}

}  // namespace sepcal::bindings
