// SPDX-License-Identifier: BSD-3-Clause
// A simulated flight reduced for its fleet: what its triangle says at another point is what its
// model says there, and its own parameters are at their best.
#include "sepcal/flight/flight_factor.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "flights_with_effects.hpp"
#include "sepcal/error.hpp"

namespace flight_factor_test {

using namespace sepcal;
using namespace sepcal::test;
using doctest::Approx;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

Conditions noisy(std::uint64_t seed) {
  Conditions conditions;
  conditions.noise = 0.15;
  conditions.seed = seed;
  return conditions;
}

const ReduceOptions of_wind{.own = {"w_n", "w_e", "w_d"}};

}  // namespace

TEST_CASE("a flight's triangle is its misfit to first order") {
  const SimulatedFlight simulated = fly("pitot-static", {}, noisy(3));
  const Flight flight = make_flight(simulated);
  const Calibration calibration = calibrate_with("pitot-static", simulated, {});
  ReduceOptions options = of_wind;
  options.candidates = {"pressure_offset[throttle]", "no_such[throttle]", "wind[altitude_m]"};
  const FlightFactor factor = reduce(calibration, flight, options);
  CHECK(factor.parameters == std::vector<std::string>{"s_va", "c_va"});
  REQUIRE(factor.columns.size() == 3);  // one offset and two components of the wind
  const Index side = factor.triangle.rows();
  REQUIRE(side == 2 + 3 + 1);
  CHECK(factor.triangle.isUpperTriangular());
  // At the fit, which takes the residual for white, little of it is along the parameters.
  CHECK(factor.triangle.col(side - 1).head(2).norm() < 0.1);
  CHECK(factor.own.at("w_n") == Approx(calibration.fit["w_n"].value));

  // A step of a standard error away the misfit has grown by what the triangle says.
  const double step = 1.0 / factor.triangle.col(0).norm();
  ReduceOptions moved = options;
  moved.at = {{"s_va", factor.values[0] + step}};
  const FlightFactor there = reduce(calibration, flight, moved);
  CHECK(there.values[0] == Approx(factor.values[0] + step));
  VectorXd away = VectorXd::Zero(side);
  away[0] = step;
  away[side - 1] = -1.0;
  const double expected = (factor.triangle * away).squaredNorm();
  CHECK(there.triangle.col(side - 1).squaredNorm() == Approx(expected).epsilon(0.01));
}

TEST_CASE("effects that a fleet can test are linear, and not in the calibration") {
  const SimulatedFlight simulated = fly("pitot-static", {}, noisy(4));
  const Flight flight = make_flight(simulated);
  const Calibration calibration = calibrate_with("pitot-static", simulated, {});
  const std::vector<std::string> names = list_fleet_candidates(calibration, flight);
  CHECK(std::ranges::find(names, "wind[altitude_m]") != names.end());
  CHECK(std::ranges::none_of(names, [](const std::string& name) {
    return name.find("spline") != std::string::npos || name.find("levels") != std::string::npos;
  }));
}

TEST_CASE("misuse is an error that names it") {
  const SimulatedFlight simulated = fly("pitot-static", {}, noisy(5));
  const Flight flight = make_flight(simulated);
  const Calibration calibration = calibrate_with("pitot-static", simulated, {});
  ReduceOptions unknown = of_wind;
  unknown.at = {{"s_vb", 1.0}};
  CHECK_THROWS_WITH_AS(reduce(calibration, flight, unknown),
                       doctest::Contains("no parameter is called 's_vb'"), Error);
}

}  // namespace flight_factor_test
