// SPDX-License-Identifier: BSD-3-Clause
// A membrane's airspeed in closed form; that the pressure behind an SDP3x' airspeed is the inverse
// of what is indicated. The formulas themselves are held in tests/python/test_export_airspeed.py.
#include "flight/export/airspeed_reader.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "sepcal/error.hpp"

namespace airspeed_reader_test {

using namespace sepcal::exporting;

namespace {

constexpr Air sea_level{.pressure = 101325.0, .temperature = 288.15};

}  // namespace

TEST_CASE("a membrane's pressure is taken as it is") {
  const AirspeedReader reader;
  CHECK(reader.indicate(245.0, sea_level).scaled == doctest::Approx(20.0));  // sqrt(2 245 / 1.225)
  CHECK(reader.indicate(245.0, sea_level).added == 0.0);
  CHECK(reader.pressure_behind(22.0, 1.1, sea_level) == doctest::Approx(245.0));
}

TEST_CASE("the pressure behind an SDP3x' airspeed is found again") {
  for (const auto& reader : {AirspeedReader::px4({0, 0.2, 1.5}), AirspeedReader::px4({1, 1.0, 1.5}),
                             AirspeedReader::px4({2, 0.2, 1.5}), AirspeedReader::ardupilot()}) {
    CHECK(reader.flows());
    for (const double dp : {30.0, 200.0, 450.0}) {
      for (const Air& air : {sea_level, Air{.pressure = 70000.0, .temperature = 265.0}}) {
        const IndicatedAirspeed one = reader.indicate(dp, air);
        CHECK(reader.pressure_behind(1.07 * one.scaled + one.added, 1.07, air) ==
              doctest::Approx(dp).epsilon(1e-12));
      }
    }
  }
}

TEST_CASE("without a pressure no airspeed is indicated") {
  for (const double dp : {0.0, -5.0, std::nan("")}) {
    CHECK(AirspeedReader::px4({0, 0.2, 1.5}).indicate(dp, sea_level).scaled == 0.0);
  }
  CHECK(AirspeedReader::ardupilot().pressure_behind(0.0, 1.0, sea_level) == 0.0);
}

TEST_CASE("settings that PX4 does not know are refused") {
  using Settings = std::array<double, 3>;
  for (const Settings& wrong : {Settings{4, 0.2, 1.5}, Settings{0.5, 0.2, 1.5},
                                Settings{0, 11, 1.5}, Settings{0, 0.2, 0}}) {
    CHECK_THROWS_AS(AirspeedReader::px4(wrong), sepcal::OptionError);
  }
}

}  // namespace airspeed_reader_test
