// SPDX-License-Identifier: BSD-3-Clause
// Hidden effects that there aren't, drivers that a log doesn't have, sizes that don't fit: one line
// each, with the culprit and what would do.
#include <doctest/doctest.h>
#include <cmath>

#include "calibrated_flights.hpp"
#include "simulated_flights.hpp"

namespace simulate_refusals_test {

namespace {

using namespace sepcal;
using namespace sepcal::test;
using Words = std::initializer_list<std::string_view>;

void refuse_five_hole(const SizedEffect& effect, Words words) {
  CAPTURE(effect.name);
  check_refused([&] { simulate_five_hole(hiding(FiveHoleTruth{}, {effect}), condensed(40)); },
                words);
}

void refuse_magnetometer(const SizedEffect& effect, Words words) {
  CAPTURE(effect.name);
  check_refused(
      [&] { simulate_magnetometer(hiding(MagnetometerTruth{}, {effect}), condensed(40)); }, words);
}

}  // namespace

TEST_CASE("an effect that the probe doesn't have") {
  refuse_five_hole({"gusts", {1}}, {"truth: 'gusts' is no effect of the simulated five-hole probe",
                                    "wind[DRIVER]", "pneumatic_lag", "propwash"});
  refuse_five_hole({"bias[time]", {1}}, {"'bias[time]'", "airspeed_bias[DRIVER]"});
  refuse_five_hole({"wind", {1}}, {"'wind'", "wind[DRIVER]"});
  refuse_five_hole({"wind[]", {1}}, {"'wind[]'", "wind[DRIVER]"});
  refuse_five_hole({"heading_bias[time]", {1}}, {"'heading_bias[time]'", "heading_bias,"});
  refuse_five_hole({"", {1}}, {"''", "wind[DRIVER]"});
  refuse_magnetometer({"wind[time]", {1}},
                      {"'wind[time]'", "magnetometer", "bias[DRIVER]", "sensor_lag", "bias_drift"});
  check_refused(
      [] {
        simulate_pitot_static(hiding(PitotStaticTruth{}, {{"heading_bias", {1}}}), condensed(9));
      },
      {"'heading_bias'", "pitot-static tube", "airspeed_scale[DRIVER]"});
}

TEST_CASE("a driver that the log doesn't have, or that isn't one") {
  for (const char* name : {"wind[humidity_pct]", "wind[humidity_pct^2]", "wind[humidity_pct^n]",
                           "wind[spline(humidity_pct,5)]", "wind[delay(humidity_pct)]"}) {
    refuse_five_hole({name, {1}},
                     {name, "'humidity_pct'", "altitude_m, throttle", "alpha, beta", "maneuver"});
  }
  refuse_five_hole({"wind[decoy_1]", {1}}, {"'decoy_1'"});
  refuse_five_hole({"wind[vn_mps]", {1}}, {"'vn_mps'"});
  refuse_magnetometer({"bias[alpha]", {1}}, {"'alpha'", "voltage_v", "p, q, r"});
  for (const char* name :
       {"wind[flap^0]", "wind[flap^10]", "wind[flap^-1]", "wind[flap^1.5]", "wind[flap^]",
        "wind[spline(flap)]", "wind[step(flap)]", "wind[sin(time)]", "wind[decay(throttle)]"}) {
    refuse_five_hole({name, {1}}, {name, "x^2 to x^9", "spline(x,k)", "delay(x)"});
  }
  for (const char* name : {"wind[spline(time,2)]", "wind[spline(time,-4)]", "wind[spline(time,x)]",
                           "wind[spline(time,1001)]"}) {
    refuse_five_hole({name, {1}}, {name, "3 to 1000 knots"});
  }
  refuse_five_hole({"wind[delay(time)]", {1}}, {"delay(time)", "a column or a body rate"});
  refuse_five_hole({"wind[delay(alpha)]", {1}}, {"delay(alpha)", "a column or a body rate"});
}

TEST_CASE("sizes of another number than the components'") {
  refuse_five_hole({"wind[time]", {1, 2, 3}},
                   {"wind[time] is given 3 sizes", "wind[time].n, wind[time].e"});
  refuse_five_hole({"heading_bias", {0.1, 0.2}}, {"2 sizes", "heading_bias.delta"});
  refuse_five_hole({"wind[spline(time,4)]", {1, 2, 3, 4}}, {"4 sizes", "n_2", "e_4"});
  refuse_magnetometer({"bias_step", {1, 2}},
                      {"2 sizes", "bias_step.t0", "the last may be left out"});
  refuse_magnetometer({"eddy_currents", {1, 2, 3, 4}}, {"4 sizes", "eddy_currents.zz"});
  refuse_magnetometer({"bias[time]", {}}, {"'bias[time].x' is missing", "bias[time].z"});
}

TEST_CASE("sizes out of range") {
  refuse_five_hole({"wind[time]", {std::nan("")}}, {"wind[time].n", "finite"});
  refuse_magnetometer({"warm_up", {1, 1, 1, 0}}, {"warm_up: tau = 0", "above 0"});
  refuse_magnetometer({"bias[throttle^n]", {1, 1, 1, -0.5}}, {"exponent = -0.5", "above 0"});
  refuse_magnetometer({"sensor_lag", {-0.1}}, {"sensor_lag: tau = -0.1 s", "0 to 2 s"});
  refuse_five_hole({"pneumatic_lag", {3}}, {"pneumatic_lag: tau = 3 s", "0 to 2 s"});
  refuse_five_hole({"time_offset", {11}}, {"time_offset: tau = 11 s", "within +-10 s"});
  refuse_magnetometer({"bias[delay(current_a)]", {1, 1, 1, 20}}, {"tau = 20 s", "within +-10 s"});
  refuse_five_hole({"airspeed_scale[flap]", {-2}}, {"no reading", "smaller"});
  refuse_five_hole({"pressure_offset[throttle]", {5000}}, {"no reading", "smaller"});
}

TEST_CASE("what a flight can't drive") {
  SimulationOptions poor = condensed(50);
  poor.excitation = Excitation::poor;
  check_refused(
      [&] { simulate_five_hole(hiding(FiveHoleTruth{}, {{"wind[maneuver]", {1}}}), poor); },
      {"wind[maneuver]", "cruise", "two maneuvers"});
  check_refused(
      [&] {
        simulate_five_hole(hiding(FiveHoleTruth{}, {{"wind[spline(time,4)]", {1}}}), condensed(1));
      },
      {"time is constant"});
}

TEST_CASE("an effect hidden twice, under whatever name") {
  FiveHoleTruth truth = hiding(FiveHoleTruth{}, {{"wind_shear", {1}}, {"wind[altitude_m]", {1}}});
  check_refused([&] { simulate_five_hole(truth, condensed(9)); },
                {"wind[altitude_m] is hidden twice"});
}

TEST_CASE("an effect and its sizes as they are typed") {
  CHECK(parse_sized_effect("wind[time]=0.5", "--hide").name == "wind[time]");
  CHECK(parse_sized_effect("bias_step=1:-2.5:3e-2:40", "--hide").sizes ==
        std::vector{1.0, -2.5, 0.03, 40.0});
  for (const char* text : {"wind[time]", "=3", ""}) {
    check_refused([&] { parse_sized_effect(text, "--hide"); }, {"E=SIZE", "e.g. wind[time]"});
  }
  for (const char* text : {"wind[time]=", "wind[time]=a", "wind[time]=1:", "wind[time]=1::2",
                           "wind[time]=nan", "wind[time]=1,2"}) {
    check_refused([&] { parse_sized_effect(text, "--hide"); },
                  {"--hide wind[time]=", "is not a number"});
  }
}

}  // namespace simulate_refusals_test
