// SPDX-License-Identifier: BSD-3-Clause
// The catalogue that people read against the kits that effects are made of.
#include "sepcal/detail/flight/effect_catalogue.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>

#include "sepcal/detail/flight/probe_effects.hpp"

namespace effect_catalogue_test {

using namespace sepcal;
using Names = std::set<std::string, std::less<>>;

namespace {

constexpr std::array models{"five-hole", "vane-boom", "pitot-static", "magnetometer",
                            "magnetometer-norm"};

}  // namespace

TEST_CASE("the catalogue has what a probe's effects are made of, and no other") {
  for (const char* model : models) {
    CAPTURE(model);
    Names ports;
    Names others;
    for (const CataloguedEffect& effect : effect_catalogue(model)) {
      const auto bracket = effect.name.find('[');
      (bracket == std::string_view::npos ? others : ports).emplace(effect.name.substr(0, bracket));
    }
    const EffectKit kit = effect_kit(model);
    Names ports_of_kit;
    Names others_of_kit;
    for (const Port& port : kit.ports) ports_of_kit.insert(port.name);
    for (const auto& [name, maker] : kit.own) others_of_kit.insert(name);
    for (const auto& [name, resolve] : kit.aliases) others_of_kit.insert(name);
    CHECK(ports == ports_of_kit);
    CHECK(others == others_of_kit);
  }
}

TEST_CASE("every port may be driven by anything, and says so") {
  for (const char* model : models) {
    Names open;
    for (const CataloguedEffect& effect : effect_catalogue(model)) {
      if (effect.name.ends_with("[DRIVER]")) open.emplace(effect.name);
    }
    for (const Port& port : effect_kit(model).ports) CHECK(open.contains(port.name + "[DRIVER]"));
  }
}

TEST_CASE("the ports and effects that every user relies on are there") {
  const auto has = [](std::string_view model, std::string_view name) {
    return std::ranges::any_of(effect_catalogue(model),
                               [&](const auto& effect) { return effect.name == name; });
  };
  for (const char* name : {"wind[DRIVER]", "airspeed_scale[DRIVER]", "airspeed_bias[DRIVER]",
                           "pressure_offset[DRIVER]", "pressure_offset", "alpha_offset[DRIVER]",
                           "beta_offset[DRIVER]", "heading_bias", "time_offset", "pneumatic_lag",
                           "lever_arm", "wind_shear", "wind_drift", "propwash"}) {
    CAPTURE(name);
    CHECK(has("five-hole", name));
  }
  for (const char* name :
       {"bias[DRIVER]", "scale[DRIVER]", "axis_scale[DRIVER]", "bias_step", "cubic_nonlinearity",
        "time_offset", "sensor_lag", "field_declination", "bias_drift"}) {
    CAPTURE(name);
    CHECK(has("magnetometer", name));
  }
}

TEST_CASE("no name twice, no entry empty, brackets closed") {
  for (const char* model : models) {
    Names seen;
    for (const CataloguedEffect& effect : effect_catalogue(model)) {
      CAPTURE(effect.name);
      CHECK(seen.emplace(effect.name).second);
      CHECK((effect.name.find('[') == std::string_view::npos) == !effect.name.ends_with(']'));
      CHECK(!effect.equation.empty());
      CHECK(!effect.drivers.empty());
      CHECK(!effect.unit.empty());
    }
  }
}

TEST_CASE("another model has none") {
  CHECK(effect_catalogue("venturi").empty());
  CHECK(effect_catalogue("").empty());
}

}  // namespace effect_catalogue_test
