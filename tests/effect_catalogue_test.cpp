// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/effect_catalogue.hpp"

#include <doctest/doctest.h>

#include <set>
#include <string>

using namespace sepcal;
using Names = std::set<std::string, std::less<>>;

namespace {

/// The ports (the part before the bracket) and the effects with a physics of their own.
struct Contents {
  Names ports;
  Names own;
};

Contents list_contents(std::string_view model) {
  Contents contents;
  for (const CataloguedEffect& effect : effect_catalogue(model)) {
    const auto bracket = effect.name.find('[');
    (bracket == std::string_view::npos ? contents.own : contents.ports)
        .emplace(effect.name.substr(0, bracket));
  }
  return contents;
}

}  // namespace

TEST_CASE("the catalogue has every port and physical effect of each probe, and no other") {
  const Contents probe = list_contents("five-hole");
  CHECK(probe.ports == Names{"wind", "airspeed_scale", "airspeed_bias", "pressure_offset",
                             "alpha_offset", "beta_offset"});
  CHECK(probe.own == Names{"heading_bias", "time_offset", "pneumatic_lag", "lever_arm"});
  const Contents magnetometer = list_contents("magnetometer");
  CHECK(magnetometer.ports == Names{"bias", "scale", "axis_scale"});
  CHECK(magnetometer.own ==
        Names{"bias_step", "cubic_nonlinearity", "time_offset", "sensor_lag", "field_declination"});
}

TEST_CASE("no name twice, no entry empty, brackets closed") {
  for (const char* model : {"five-hole", "magnetometer"}) {
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
