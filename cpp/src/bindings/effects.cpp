// SPDX-License-Identifier: BSD-3-Clause
// What effects there are, and what their names mean.
#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "bindings.hpp"
#include "sepcal/effect_name.hpp"
#include "sepcal/flight/effect_catalogue.hpp"

namespace sepcal::bindings {
namespace {

using namespace py::literals;

/// Keys as the fields of sepcal.CataloguedEffect.
py::list catalogue(const std::string& probe) {
  py::list list;
  for (const CataloguedEffect& effect : effect_catalogue(probe)) {
    list.append(py::dict("name"_a = effect.name, "equation"_a = effect.equation,
                         "drivers"_a = effect.drivers, "unit"_a = effect.unit));
  }
  return list;
}

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
  module.def("effects", &catalogue);
  module.def("channels", &channels);
}

}  // namespace sepcal::bindings
