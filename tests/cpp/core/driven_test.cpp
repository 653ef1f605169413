// SPDX-License-Identifier: BSD-3-Clause
// Effects `port[driver^k]` at compile time: their names, units and phi = (d - centre)^k.
#include "sepcal/detail/effects/driven.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "composed_checks.hpp"
#include "sepcal/detail/run_time_effect.hpp"

namespace driven_test {

using doctest::Approx;
using sepcal::Quantity;
using sepcal::Vec;
using namespace sepcal::effects;

namespace {

using Shear = Follows<"wind", "altitude_m", 1, "m/s", Component<"n", "w_n">, Component<"e", "w_e">>;
using Loss = Follows<"airspeed_scale", "alpha", 2, "1", Component<"s", "lambda_va">>;
using Wash = Shifts<"pressure_offset", "throttle", 3, "Pa">;

}  // namespace

TEST_CASE("parameters are called port[driver^k].component, without a power of one") {
  static_assert(Shear::linear.size() == 2);
  CHECK(Shear::linear[0].name == "wind[altitude_m].n");
  CHECK(Shear::linear[1].name == "wind[altitude_m].e");
  CHECK(Shear::linear[1].unit == "m/s");
  CHECK(Shear::targets[0] == "w_n");
  CHECK(Shear::targets[1] == "w_e");
  CHECK(Loss::linear[0].name == "airspeed_scale[alpha^2].s");
  CHECK(Wash::nonlinear[0].name == "pressure_offset[throttle^3].s");
  CHECK(Wash::nonlinear[0].unit == "Pa");
}

TEST_CASE("their inputs are the driver, of any unit, and the port, zero where it is absent") {
  static_assert(Shear::inputs.size() == 1);
  CHECK(Shear::inputs[0].name == "altitude_m");
  CHECK(Shear::inputs[0].unit.empty());
  CHECK(std::isnan(Shear::inputs[0].absent));
  CHECK(Wash::inputs[0].name == "pressure_offset");
  CHECK(Wash::inputs[0].unit == "Pa");
  CHECK(Wash::inputs[0].absent == 0.0);
  CHECK(Wash::inputs[1].name == "throttle");
}

TEST_CASE("phi is a power of the distance from the centre") {
  const Vec<double, 0> none;
  CHECK(Shear{250.0}.factor(Vec<double, 1>(300.0), none) == 50.0);
  CHECK(Loss{0.1}.factor(Vec<double, 1>(-0.2), none) == Approx(0.09));
  CHECK(Shear{}.centre == 0.0);
  const Vec<double, 1> shifted = Wash{0.5}.correct(Vec<double, 2>(7.0, 0.9), Vec<double, 1>(100.0));
  CHECK(shifted[0] == Approx(7.0 + 100.0 * 0.4 * 0.4 * 0.4));
  CHECK(power_of<9>(2.0, 0.0) == 512.0);
}

TEST_CASE("each is the kind of effect that it is taken for") {
  static_assert(sepcal::VaryingTerm<Shear> && sepcal::StaticEffect<Shear>);
  static_assert(!sepcal::Term<Shear> && !sepcal::InputCorrection<Shear>);
  static_assert(sepcal::InputCorrection<Wash> && sepcal::StaticEffect<Wash>);
  static_assert(!sepcal::Term<Wash> && !sepcal::VaryingTerm<Wash>);
}

}  // namespace driven_test
