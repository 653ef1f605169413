// SPDX-License-Identifier: BSD-3-Clause
// What drives an effect: phi against its definition, its slope against differences.
#include "sepcal/detail/driver.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "composed_models.hpp"
#include "sepcal/error.hpp"

namespace driver_test {

using doctest::Approx;
using doctest::Contains;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Driver;
using sepcal::DriverPointer;
using sepcal::Variable;

namespace {

const Variable channel("d", "A");
const Variable time_axis("time", "s");

struct Phi {
  MatrixXd values;
  MatrixXd slopes;
};

/// phi and its slope at the values `d`, in blocks of `most` rows.
Phi evaluate(const Driver& driver, const std::vector<double>& d, double shape,
             std::size_t most = 1000) {
  const auto rows = static_cast<Index>(d.size());
  Phi phi{MatrixXd::Constant(rows, driver.functions(), sepcal::not_a_number),
          MatrixXd::Constant(rows, driver.functions(), sepcal::not_a_number)};
  for (std::size_t first = 0; first < d.size(); first += most) {
    const auto count = static_cast<Index>(std::min(most, d.size() - first));
    MatrixXd values(count, driver.functions());
    MatrixXd slopes(count, driver.functions());
    driver.evaluate(driver.input() ? d.data() + first : nullptr, first, shape, values, &slopes);
    MatrixXd alone(count, driver.functions());
    driver.evaluate(driver.input() ? d.data() + first : nullptr, first, shape, alone, nullptr);
    CHECK(alone == values);
    phi.values.middleRows(static_cast<Index>(first), count) = values;
    phi.slopes.middleRows(static_cast<Index>(first), count) = slopes;
  }
  return phi;
}

void check_slope(const Driver& driver, const std::vector<double>& d, double shape,
                 double tolerance) {
  const double step = 1e-5 * std::abs(shape);
  const MatrixXd numeric =
      (evaluate(driver, d, shape + step).values - evaluate(driver, d, shape - step).values) /
      (2 * step);
  const MatrixXd given = evaluate(driver, d, shape).slopes;
  REQUIRE(numeric.cwiseAbs().maxCoeff() > 0);
  CHECK((given - numeric).cwiseAbs().maxCoeff() < tolerance * numeric.cwiseAbs().maxCoeff());
}

}  // namespace

TEST_CASE("a constant reads no column and is one") {
  const DriverPointer driver = sepcal::constant_driver();
  CHECK_FALSE(driver->input().has_value());
  CHECK_FALSE(driver->shape().has_value());
  CHECK(driver->suffixes() == std::vector<std::string>{""});
  CHECK(driver->reach() == 0.0);
  CHECK(evaluate(*driver, {5, -3}, 0).values == VectorXd::Ones(2));
}

TEST_CASE("a power of the distance from the centre") {
  const std::vector<double> d{-2.0, 0.0, 1.5, 3.0};
  for (int power = 1; power <= 9; ++power) {
    const Phi phi = evaluate(*sepcal::power_driver(channel, 1.5, power), d, 0);
    for (Index i = 0; i < 4; ++i) {
      CHECK(phi.values(i, 0) == Approx(std::pow(d[static_cast<std::size_t>(i)] - 1.5, power)));
    }
  }
  CHECK(sepcal::power_driver(channel, 0, 2)->input()->name == "d");
  for (const int power : {0, -1, 10}) {
    CHECK_THROWS_WITH_AS(sepcal::power_driver(channel, 0, power), Contains("of 'd' must be"),
                         sepcal::Error);
  }
}

TEST_CASE("a fitted exponent: max(d, 0)^n and its slope") {
  const DriverPointer driver = sepcal::exponent_driver(channel);
  REQUIRE(driver->shape().has_value());
  CHECK(driver->shape()->name == "exponent");
  CHECK(driver->shape()->lower == 0.3);
  CHECK(driver->shape()->upper == 2.0);
  const std::vector<double> d{-1.0, 0.0, 0.25, 1.0, 4.0};
  const Phi phi = evaluate(*driver, d, 0.5);
  CHECK((phi.values - (VectorXd(5) << 0, 0, 0.5, 1, 2).finished()).norm() < 1e-15);
  CHECK(phi.slopes.allFinite());
  check_slope(*driver, d, 1.3, 1e-8);
}

TEST_CASE("levels: a function a threshold, one from there on and below the next") {
  const auto driver = sepcal::levels_driver(channel, {-1.0, 10.0, 30.0});
  CHECK(driver->suffixes() == std::vector<std::string>{"_2", "_3", "_4"});
  const MatrixXd phi = evaluate(*driver, {-1.1, -1.0, 9.9, 10.0, 29.0, 30.0, 1e9}, 0.0, 3).values;
  MatrixXd expected = MatrixXd::Zero(7, 3);
  expected(1, 0) = expected(2, 0) = expected(3, 1) = expected(4, 1) = 1.0;
  expected(5, 2) = expected(6, 2) = 1.0;
  CHECK(phi == expected);
  CHECK_THROWS_WITH_AS(sepcal::levels_driver(channel, {}),
                       "levels of 'd' take thresholds that rise", sepcal::Error);
  CHECK_THROWS_AS(sepcal::levels_driver(channel, {2.0, 1.0}), sepcal::Error);
}

TEST_CASE("a spline's functions are zero at the first knot and one at their own") {
  const DriverPointer driver = sepcal::spline_driver(channel, {0, 1, 3, 4});
  CHECK(driver->suffixes() == std::vector<std::string>{"_2", "_3", "_4"});
  const Phi phi = evaluate(*driver, {0, 1, 3, 4}, 0);
  CHECK((phi.values.bottomRows(3) - MatrixXd::Identity(3, 3)).norm() < 1e-14);
  CHECK(phi.values.row(0).norm() < 1e-14);
  CHECK(phi.slopes == MatrixXd::Zero(4, 3));
  CHECK_THROWS_AS(sepcal::spline_driver(channel, {0, 1}), sepcal::Error);
  CHECK_THROWS_WITH(sepcal::spline_driver(channel, {0, 1, 3, 4}, {0.5}),
                    "a spline of 4 knots has 3 functions, but 1 means were given");
}

TEST_CASE("a label's function is one in its own segments; the first label has none") {
  const DriverPointer driver = sepcal::category_driver({"maneuver", ""}, {"climb", "box", "loop"});
  CHECK(driver->suffixes() == std::vector<std::string>{"_box", "_loop"});
  const Phi phi = evaluate(*driver, {0, 1, 2, 1, -1}, 0);
  MatrixXd expected(5, 2);
  expected << 0, 0, 1, 0, 0, 1, 1, 0, 0, 0;
  CHECK(phi.values == expected);
  CHECK_THROWS_WITH_AS(sepcal::category_driver({"maneuver", ""}, {"all"}),
                       Contains("'maneuver' has fewer than two labels"), sepcal::Error);
}

TEST_CASE("a step is one from t0 on, a ramp grows from there") {
  const DriverPointer step = sepcal::step_driver(time_axis, 10, 20);
  CHECK(step->shape()->name == "t0");
  CHECK(step->shape()->unit == "s");
  CHECK(step->shape()->lower == 10);
  CHECK(step->shape()->upper == 20);
  const std::vector<double> time{10, 12, 15, 19};
  CHECK(evaluate(*step, time, 15).values == (VectorXd(4) << 0, 0, 1, 1).finished());
  CHECK(evaluate(*step, time, 15).slopes == VectorXd::Zero(4));
  CHECK(step->is_step());
  const DriverPointer ramp = sepcal::ramp_driver(time_axis, 10, 20);
  CHECK(evaluate(*ramp, time, 12.5).values == (VectorXd(4) << 0, 0, 2.5, 6.5).finished());
  check_slope(*ramp, time, 12.5, 1e-8);
  // Its corner is a parabola over +-0.05 s here: a quarter of that at t0.
  CHECK(evaluate(*ramp, time, 12).values(1, 0) == doctest::Approx(0.0125).epsilon(1e-12));
  check_slope(*ramp, time, 12.01, 1e-8);
  CHECK_FALSE(ramp->is_step());
}

TEST_CASE("a decay begins at one at the record's first time") {
  const DriverPointer decay = sepcal::decay_driver(time_axis, 100, 160);
  CHECK(decay->shape()->name == "tau");
  CHECK(decay->shape()->lower == Approx(0.6));
  CHECK(decay->shape()->upper == Approx(120.0));
  const Phi phi = evaluate(*decay, {100, 120, 160}, 20);
  CHECK(phi.values(0, 0) == 1.0);
  CHECK(phi.values(1, 0) == Approx(std::exp(-1.0)));
  CHECK(phi.values(2, 0) == Approx(std::exp(-3.0)));
  check_slope(*decay, {100, 120, 160}, 20, 1e-8);
}

TEST_CASE("a delayed driver is the channel's signal at t - tau, in blocks of any size") {
  const std::vector<double> time = sepcal::test::uneven_times(400, 0.02);
  const auto signal = [](double t) { return 3.0 + 2.0 * std::sin(1.5 * t); };
  const sepcal::Record record = sepcal::test::sample({{"d", signal}}, time);
  const DriverPointer driver = sepcal::delay_driver(channel, record, 0.2);
  CHECK(driver->reach() == 0.2);
  CHECK(driver->shape()->name == "tau");
  CHECK(driver->shape()->lower == -0.2);
  CHECK(driver->shape()->upper == 0.2);
  const auto logged = record.column("d");
  const std::vector<double> d(logged.begin(), logged.end());
  for (const double tau : {-0.17, 0.05, 0.2}) {
    CAPTURE(tau);
    const Phi phi = evaluate(*driver, d, tau, 37);
    for (std::size_t k = 15; k < 385; ++k) {
      const auto row = static_cast<Index>(k);
      CHECK(std::abs(phi.values(row, 0) - signal(time[k] - tau)) < 1e-6);
      CHECK(std::abs(phi.slopes(row, 0) + 3.0 * std::cos(1.5 * (time[k] - tau))) < 1e-3);
    }
    check_slope(*driver, d, tau, 1e-6);
  }
}

TEST_CASE("a delayed driver doesn't see past its segment") {
  sepcal::Record record;
  record.add("time", {0, 1, 2, 3, 4, 5}).add("d", {0, 2, 4, 100, 99, 98});
  record.cut({{"up", 0, 3}, {"down", 3, 6}});
  const DriverPointer driver = sepcal::delay_driver(channel, record, 2.0);
  MatrixXd values(3, 1);
  const double unused = 0;
  driver->evaluate(&unused, 0, -1.5, values, nullptr);
  CHECK((values - Eigen::Vector3d(3, 5, 7)).norm() < 1e-13);
  driver->evaluate(&unused, 3, 1.5, values, nullptr);
  CHECK((values - Eigen::Vector3d(101.5, 100.5, 99.5)).norm() < 1e-12);
}

}  // namespace driver_test
