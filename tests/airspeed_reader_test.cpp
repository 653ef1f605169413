// SPDX-License-Identifier: BSD-3-Clause
// A membrane's airspeed in closed form; that the pressure behind an SDP3x' airspeed is the inverse
// of what is indicated. The formulas themselves are held in tests/python/test_export_airspeed.py.
#include "flight/export/airspeed_reader.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "sepcal/option_error.hpp"
#include "sepcal/record.hpp"

namespace sepcal::exporting {
namespace {

constexpr Air sea_level{.pressure = 101325.0, .temperature = 288.15};

TEST(AirspeedReader, TakesAMembranesPressureAsItIs) {
  const AirspeedReader reader;
  EXPECT_NEAR(reader.indicate(245.0, sea_level).scaled, 20.0, 1e-12);  // sqrt(2 245 / 1.225)
  EXPECT_EQ(reader.indicate(245.0, sea_level).added, 0.0);
  EXPECT_NEAR(reader.pressure_behind(22.0, 1.1, sea_level), 245.0, 1e-10);
}

TEST(AirspeedReader, FindsThePressureBehindAnAirspeed) {
  for (const auto& reader : {AirspeedReader::px4({0, 0.2, 1.5}), AirspeedReader::px4({1, 1.0, 1.5}),
                             AirspeedReader::px4({2, 0.2, 1.5}), AirspeedReader::ardupilot()}) {
    for (const double dp : {30.0, 200.0, 450.0}) {
      for (const Air& air : {sea_level, Air{.pressure = 70000.0, .temperature = 265.0}}) {
        const IndicatedAirspeed one = reader.indicate(dp, air);
        EXPECT_NEAR(reader.pressure_behind(1.07 * one.scaled + one.added, 1.07, air), dp, 1e-9);
      }
    }
  }
}

TEST(AirspeedReader, GivesNothingWithoutAPressure) {
  for (const double dp : {0.0, -5.0, std::nan("")}) {
    EXPECT_EQ(AirspeedReader::px4({0, 0.2, 1.5}).indicate(dp, sea_level).scaled, 0.0);
  }
  EXPECT_EQ(AirspeedReader::ardupilot().pressure_behind(0.0, 1.0, sea_level), 0.0);
}

TEST(AirspeedReader, RefusesWhatPx4DoesNotKnow) {
  using Settings = std::array<double, 3>;
  for (const Settings& wrong : {Settings{4, 0.2, 1.5}, Settings{0.5, 0.2, 1.5},
                                Settings{0, 11, 1.5}, Settings{0, 0.2, 0}}) {
    EXPECT_THROW(AirspeedReader::px4(wrong), OptionError);
  }
}

TEST(Record, ReplacesAColumn) {
  Record record;
  record.add("a", {1.0, 2.0}).add("b", {3.0, 4.0});
  record.replace("a", {5.0, 6.0});
  EXPECT_EQ(record.column("a")[1], 6.0);
  EXPECT_EQ(record.column("b")[1], 4.0);
  EXPECT_THROW(record.replace("c", {1.0, 2.0}), Error);
  EXPECT_THROW(record.replace("a", {1.0}), Error);
}

}  // namespace
}  // namespace sepcal::exporting
