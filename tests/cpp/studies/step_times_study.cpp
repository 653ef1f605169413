// SPDX-License-Identifier: BSD-3-Clause
// The times of steps, found over many seeds, with coefficients that are linear or not.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>

#include "flights_with_steps.hpp"
#include "studies/seeds.hpp"

namespace step_times_study {

using namespace sepcal;
using namespace sepcal::test;

TEST_CASE("the time of a step is found within one row over many seeds") {
  // A row on the wrong side costs |(2, -1, 3)|^2 / 0.3^2 = 155 in the sum of squares: the noise
  // makes up for it less than once in 10^9 times.
  constexpr std::uint64_t count = seeds(20, 2);
  double farthest = 0.0;  // [rows]
  for (std::uint64_t seed = 0; seed < count; ++seed) {
    CAPTURE(seed);
    const SimulatedFlight flight =
        fly("magnetometer", {bias_step}, {.rows = 300, .noise = 0.3, .seed = seed});
    const Calibration calibration = calibrate_with("magnetometer", flight, {"bias_step"});
    const double rows_off = error_of(calibration, flight, "bias_step.t0") / row_interval(flight);
    farthest = std::max(farthest, rows_off);
    CHECK(rows_off < 1.0);
    CHECK(calibration.fit["bias_step.t0"].fixed);
    CHECK(calibration.options.effects[0].t0 == calibration.fit["bias_step.t0"].value);
    CHECK(!calibration.options.fit.fix.contains("bias_step.t0"));
  }
  MESSAGE("the farthest of ", count, " is ", farthest, " rows off");
}

TEST_CASE("so it is where its coefficient is nonlinear") {
  constexpr std::uint64_t count = seeds(5, 1);
  double farthest = 0.0;  // [rows]
  for (std::uint64_t seed = 0; seed < count; ++seed) {
    CAPTURE(seed);
    const Conditions conditions{.rows = 300, .noise = 0.3, .seed = seed};
    const SimulatedFlight turning = fly("magnetometer-norm", {bias_step}, conditions);
    const Calibration strength = calibrate_with("magnetometer-norm", turning, {"bias_step"});
    // A step seen in the strength alone may be hidden for a few rows, where it is across the field.
    const double rows_off = error_of(strength, turning, "bias_step.t0") / row_interval(turning);
    farthest = std::max(farthest, rows_off);
    CHECK(rows_off < 3.0);
    CHECK(error_of(strength, turning, "bias_step.x") < 0.5);
    const SimulatedFlight air = fly("pitot-static", {{"water_blockage", {-0.15}}}, conditions);
    const Calibration tube = calibrate_with("pitot-static", air, {"water_blockage"});
    CHECK(error_of(tube, air, "water_blockage.t0") < row_interval(air));
    CHECK(error_of(tube, air, "water_blockage.s") < 0.02);
  }
  MESSAGE("in the field's strength the farthest of ", count, " is ", farthest, " rows off");
}

}  // namespace step_times_study
