// SPDX-License-Identifier: BSD-3-Clause
// What drives hidden effects, seen in a magnetometer's bias: the reading with the effect less the
// reading without it is size times phi, and phi is worked out here from the logged columns.
#include <doctest/doctest.h>
#include <cmath>

#include "numerics/decompositions.hpp"
#include "simulated_flights.hpp"
#include "simulation/hidden_spline.hpp"

namespace simulate_drivers_test {

namespace {

using namespace sepcal;
using namespace sepcal::test;
using Eigen::ArrayXd;

constexpr SimulationOptions ten_hertz{.rate = 10.0};

const SimulatedFlight& without() {
  static const SimulatedFlight flight =
      simulate_magnetometer(quiet(MagnetometerTruth{}), ten_hertz);
  return flight;
}

/// What the effect adds to an axis [uT].
ArrayXd added(const SimulatedFlight& with, const char* axis = "mx_ut") {
  return values(with, axis) - values(without(), axis);
}

SimulatedFlight fly(const char* effect, std::vector<double> sizes) {
  return simulate_magnetometer(hiding(quiet(MagnetometerTruth{}), {{effect, std::move(sizes)}}),
                               ten_hertz);
}

void check_equal(const ArrayXd& found, const ArrayXd& expected) {
  CHECK(expected.abs().maxCoeff() > 0.1);  // there is something to see
  CHECK((found - expected).abs().maxCoeff() < 1e-11);
}

ArrayXd logged(const char* name) { return values(without(), name); }

/// The natural cubic spline through (x_i, y_i) at `at`: every piece a + b s + c s^2 + d s^3 from
/// one dense system of all its conditions.
double dense_spline(const ArrayXd& x, const ArrayXd& y, double at) {
  const Eigen::Index pieces = x.size() - 1;
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(4 * pieces, 4 * pieces);
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(4 * pieces);
  Eigen::Index row = 0;
  for (Eigen::Index i = 0; i < pieces; ++i) {
    const double h = x[i + 1] - x[i];
    M(row, 4 * i) = 1;
    rhs[row++] = y[i];
    M.row(row).segment(4 * i, 4) << 1, h, h * h, h * h * h;
    rhs[row++] = y[i + 1];
    if (i + 1 == pieces) break;
    M.row(row).segment(4 * i, 6) << 0, 1, 2 * h, 3 * h * h, 0, -1;
    ++row;
    M.row(row).segment(4 * i, 7) << 0, 0, 2, 6 * h, 0, 0, -2;
    ++row;
  }
  M(row++, 2) = 1;
  M.row(row).tail(2) << 1, 3 * (x[pieces] - x[pieces - 1]);
  const Eigen::VectorXd c = M.fullPivLu().solve(rhs);
  Eigen::Index i = 0;
  while (i + 1 < pieces && at > x[i + 1]) ++i;
  const double s = at - x[i];
  return c[4 * i] + s * (c[4 * i + 1] + s * (c[4 * i + 2] + s * c[4 * i + 3]));
}

}  // namespace

TEST_CASE("time, altitudes and temperatures count from their mean, other columns from zero") {
  const ArrayXd t = logged("time_s"), temperature = logged("temp_degc");
  const ArrayXd warmth = temperature - temperature.mean();
  check_equal(added(fly("bias[time]", {0.02})), 0.02 * (t - t.mean()));
  check_equal(added(fly("bias[temp_degc]", {0.3})), 0.3 * warmth);
  check_equal(added(fly("bias[temp_degc^2]", {-0.05})), -0.05 * warmth.square());
  check_equal(added(fly("bias[current_a]", {0.4})), 0.4 * logged("current_a"));
  check_equal(added(fly("bias[voltage_v^3]", {1e-4})), 1e-4 * logged("voltage_v").cube());
  check_equal(added(fly("bias[r]", {2.0})), 2.0 * logged("r_radps"));
  FiveHoleTruth truth = quiet(FiveHoleTruth{});
  const SimulatedFlight plain = simulate_five_hole(truth, condensed(200));
  const SimulatedFlight sheared =
      simulate_five_hole(hiding(truth, {{"wind_shear", {0.02, -0.01}}}), condensed(200));
  const ArrayXd height = values(plain, "altitude_m") - values(plain, "altitude_m").mean();
  check_equal(values(sheared, "vn_mps") - values(plain, "vn_mps"), 0.02 * height);
  check_equal(values(sheared, "ve_mps") - values(plain, "ve_mps"), -0.01 * height);
}

TEST_CASE("each component has its own size, and one size serves them all") {
  const SimulatedFlight three = fly("bias[throttle]", {1.0, -2.0, 3.0});
  check_equal(added(three, "my_ut"), -2.0 * logged("throttle"));
  check_equal(added(three, "mz_ut"), 3.0 * logged("throttle"));
  const SimulatedFlight one = fly("bias[throttle]", {1.5});
  for (const char* axis : reading) check_equal(added(one, axis), 1.5 * logged("throttle"));
  CHECK(one.truth.at("bias[throttle].z") == 1.5);
  CHECK(one.effects == std::vector<std::string>{"bias[throttle]"});
  CHECK(one.truth.at("n_x") == MagnetometerTruth{}.parameters.at("n_x"));
}

TEST_CASE("an exponent is 0.7, or the size after the components'") {
  check_equal(added(fly("bias[throttle^n]", {2.0})), 2.0 * logged("throttle").pow(0.7));
  const SimulatedFlight given = fly("bias[panel_current_a^n]", {2.0, 1.0, 1.0, 1.6});
  check_equal(added(given), 2.0 * logged("panel_current_a").pow(1.6));
  CHECK(given.truth.at("bias[panel_current_a^n].exponent") == 1.6);
  const SimulatedFlight signed_rate = fly("bias[p^n]", {2.0, 2.0, 2.0, 1.0});
  check_equal(added(signed_rate), 2.0 * logged("p_radps").max(0.0));
}

TEST_CASE("steps, ramps and decays are shapes in time") {
  const ArrayXd t = logged("time_s");
  const double third = 320.0 / 3.0;
  check_equal(added(fly("bias_step", {2.0})), (t >= third).select(2.0, ArrayXd::Zero(t.size())));
  check_equal(added(fly("bias[step(time)]", {2.0, 2.0, 2.0, 200.0})),
              (t >= 200.0).select(2.0, ArrayXd::Zero(t.size())));
  check_equal(added(fly("bias[ramp(time)]", {0.05})), 0.05 * (t - third).max(0.0));
  check_equal(added(fly("warm_up", {5.0})), 5.0 * (-t / 64.0).exp());
  const SimulatedFlight quick = fly("bias[decay(time)]", {5.0, 5.0, 5.0, 20.0});
  check_equal(added(quick), 5.0 * (-t / 20.0).exp());
  CHECK(quick.truth.at("bias[decay(time)].tau") == 20.0);
  CHECK(fly("bias_step", {2.0}).truth.at("bias_step.t0") == third);
}

TEST_CASE("a delayed column acts as it was before") {
  const SimulatedFlight late = fly("bias[delay(current_a)]", {0.5, 0.5, 0.5, 0.3});  // three rows
  const ArrayXd current = logged("current_a");
  const Eigen::Index n = current.size() - 3;
  CHECK((added(late).tail(n) - 0.5 * current.head(n)).abs().maxCoeff() < 1e-11);
  const SimulatedFlight early = fly("bias[delay(current_a)]", {0.5, 0.5, 0.5, -0.2});
  CHECK((added(early).head(n) - 0.5 * current.segment(2, n)).abs().maxCoeff() < 1e-11);
  CHECK(fly("bias[delay(current_a)]", {0.5}).truth.at("bias[delay(current_a)].tau") == 0.05);
}

TEST_CASE("every maneuver but the first has a coefficient") {
  const SimulatedFlight flight = fly("bias[maneuver]", {1, 2, 3, 4, 5, 6, 7, 8, 9});
  const std::map<std::string, double> expected{
      {"figure_eight", 0}, {"bank", 4}, {"pitch", 5}, {"tumble", 6}};
  const ArrayXd y = added(flight, "my_ut");
  for (std::size_t k = 0; k < flight.rows(); ++k) {
    REQUIRE(y[static_cast<Eigen::Index>(k)] ==
            doctest::Approx(expected.at(flight.maneuver[k])).epsilon(1e-11));
  }
  CHECK(flight.truth.at("bias[maneuver].y_pitch") == 5);
  CHECK(fly("bias[maneuver]", {2.5}).truth.at("bias[maneuver].z_tumble") == 2.5);
}

TEST_CASE("a spline is the natural one through its coefficients") {
  const std::vector<double> sizes{3, -2, 1, 4, -1};
  std::vector<double> all = sizes;
  for (int i = 0; i < 10; ++i) all.push_back(0.5);
  for (const char* base : {"time", "temp_degc"}) {
    CAPTURE(base);
    const SimulatedFlight flight = fly(("bias[spline(" + std::string(base) + ",6)]").c_str(), all);
    const ArrayXd d = logged(std::string(base) == "time" ? "time_s" : base);
    const ArrayXd knots = ArrayXd::LinSpaced(6, d.minCoeff(), d.maxCoeff());
    ArrayXd heights(6);
    heights << 0, 3, -2, 1, 4, -1;
    ArrayXd expected(d.size());
    for (Eigen::Index k = 0; k < d.size(); k += 40)
      expected[k] = dense_spline(knots, heights, d[k]);
    const ArrayXd found = added(flight);
    for (Eigen::Index k = 0; k < d.size(); k += 40) {
      REQUIRE(found[k] == doctest::Approx(expected[k]).epsilon(1e-9));
    }
    CHECK(flight.truth.at("bias[spline(" + std::string(base) + ",6)].x_2") == 3);
    CHECK(flight.truth.at("bias[spline(" + std::string(base) + ",6)].x_6") == -1);
    CHECK(flight.truth.at("bias[spline(" + std::string(base) + ",6)].z_4") == 0.5);
  }
}

TEST_CASE("beyond its end knots a spline goes straight on") {
  const simulation::HiddenSpline spline(1.0, 4.0, {0, 2, -1, 3});
  ArrayXd x(4), y(4);
  x << 1, 2, 3, 4;
  y << 0, 2, -1, 3;
  const double h = 1e-6;
  const double left = (dense_spline(x, y, 1 + h) - dense_spline(x, y, 1)) / h;
  const double right = (dense_spline(x, y, 4) - dense_spline(x, y, 4 - h)) / h;
  CHECK(spline(0.2) == doctest::Approx(-0.8 * left).epsilon(1e-5));
  CHECK(spline(5.5) == doctest::Approx(3 + 1.5 * right).epsilon(1e-5));
}

TEST_CASE("effects add up, in any order") {
  const MagnetometerTruth truth = quiet(MagnetometerTruth{});
  const SizedEffect current{"bias[current_a]", {0.3}}, drift{"bias_drift", {0.01}};
  const SimulatedFlight one = simulate_magnetometer(hiding(truth, {current, drift}), ten_hertz);
  const SimulatedFlight other = simulate_magnetometer(hiding(truth, {drift, current}), ten_hertz);
  const ArrayXd t = logged("time_s");
  check_equal(added(one), 0.3 * logged("current_a") + 0.01 * (t - t.mean()));
  CHECK(worst_difference(one, other, "mx_ut") < 1e-12);
  CHECK(one.truth == other.truth);
  CHECK(one.truth.contains("bias[time].x"));
}

}  // namespace simulate_drivers_test
