// SPDX-License-Identifier: BSD-3-Clause
// First and second derivatives by nested duals, against closed forms and differences.
#include "sepcal/detail/nested_dual.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "block_inputs.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"
#include "sepcal/models/pitot_static.hpp"
#include "simulated_records.hpp"

namespace nested_dual_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::NestedDual;
using Dual = NestedDual<1>;

TEST_CASE("functions of one variable have the derivatives of the tables") {
  const double x = 0.7;
  const Dual t(x, 0);
  const auto check = [](const Dual& f, double value, double slope, double curvature) {
    CHECK(f.value() == Approx(value).epsilon(1e-14));
    CHECK(f.slope(0) == Approx(slope).epsilon(1e-14));
    CHECK(f.second_derivative(0, 0) == Approx(curvature).epsilon(1e-13));
  };
  check(cos(t), std::cos(x), -std::sin(x), -std::cos(x));
  check(sin(t), std::sin(x), std::cos(x), -std::sin(x));
  check(exp(2.0 * t), std::exp(2 * x), 2 * std::exp(2 * x), 4 * std::exp(2 * x));
  check(log(t), std::log(x), 1 / x, -1 / (x * x));
  check(sqrt(t), std::sqrt(x), 0.5 / std::sqrt(x), -0.25 * std::pow(x, -1.5));
  check(1.0 / t, 1 / x, -1 / (x * x), 2 / (x * x * x));
  check(t / 2.0 - 1.0, x / 2 - 1, 0.5, 0.0);
  check(3.0 - t * t, 3 - x * x, -2 * x, -2.0);
  check(pow(t, 2.5), std::pow(x, 2.5), 2.5 * std::pow(x, 1.5), 3.75 * std::sqrt(x));
  check(atan2(t, Dual(1.0)), std::atan(x), 1 / (1 + x * x), -2 * x / std::pow(1 + x * x, 2));
  check(abs(-t), x, 1.0, 0.0);
  check(fmax(t, Dual(0.1)), x, 1.0, 0.0);
  CHECK(t < 1.0);
  CHECK(0.5 < t);
  CHECK(isfinite(t));
}

TEST_CASE("other functions agree with central differences") {
  using Function = std::function<Dual(const Dual&)>;
  const std::vector<Function> functions{
      [](const Dual& t) { return cbrt(t); },        [](const Dual& t) { return exp2(t); },
      [](const Dual& t) { return expm1(t); },       [](const Dual& t) { return log2(t); },
      [](const Dual& t) { return log10(t); },       [](const Dual& t) { return log1p(t); },
      [](const Dual& t) { return tan(t); },         [](const Dual& t) { return acos(t); },
      [](const Dual& t) { return asin(t); },        [](const Dual& t) { return atan(t); },
      [](const Dual& t) { return cosh(t); },        [](const Dual& t) { return sinh(t); },
      [](const Dual& t) { return tanh(t); },        [](const Dual& t) { return erf(t); },
      [](const Dual& t) { return hypot(t, t * t); }};
  constexpr double h = 1e-4;
  for (std::size_t i = 0; i < functions.size(); ++i) {
    CAPTURE(i);
    const auto value = [&](double x) { return functions[i](Dual(x)).value(); };
    const Dual f = functions[i](Dual(0.6, 0));
    CHECK(f.slope(0) == Approx((value(0.6 + h) - value(0.6 - h)) / (2 * h)).epsilon(1e-6));
    CHECK(f.second_derivative(0, 0) ==
          Approx((value(0.6 + h) - 2 * value(0.6) + value(0.6 - h)) / (h * h)).epsilon(1e-5));
  }
}

TEST_CASE("mixed derivatives of two variables") {
  using Two = NestedDual<2>;
  const Two x(0.4, 0);
  const Two y(1.3, 1);
  const Two f = x * x * sin(y);
  CHECK(f.second_derivative(0, 0) == Approx(2 * std::sin(1.3)));
  CHECK(f.second_derivative(0, 1) == Approx(2 * 0.4 * std::cos(1.3)));
  CHECK(f.second_derivative(1, 0) == f.second_derivative(0, 1));
  CHECK(f.second_derivative(1, 1) == Approx(-0.16 * std::sin(1.3)));
}

TEST_CASE("inner and outer variables may be others, and a number knows which it depends on") {
  using Number = NestedDual<1, 5>;  // by x within, by five parameters without
  const double x = 0.4;
  const Number at(x, 0, -1);
  const auto parameter = [](double value, int i) { return Number(value, -1, i); };
  const Number f = sin(at) * parameter(1.3, 1) + at / parameter(0.7, 4) -
                   hypot(at, parameter(2.0, 0)) + atan2(parameter(0.9, 3), at);
  const double length = std::hypot(x, 2.0);
  const double square = x * x + 0.81;
  CHECK(f.slope(0) == Approx(1.3 * std::cos(x) + 1 / 0.7 - x / length - 0.9 / square));
  const std::vector<double> slopes{-2.0 / length, std::sin(x), 0.0, x / square, -x / 0.49};
  const std::vector<double> mixed{2.0 * x / std::pow(length, 3), std::cos(x), 0.0,
                                  (0.81 - x * x) / (square * square), -1 / 0.49};
  for (int i = 0; i < 5; ++i) {
    CAPTURE(i);
    CHECK(f.outer_slope(i) == Approx(slopes[static_cast<std::size_t>(i)]));
    CHECK(f.second_derivative(i, 0) == Approx(mixed[static_cast<std::size_t>(i)]));
  }
  Number sum = parameter(1.0, 4);
  sum = parameter(2.0, 0) - sum;  // those between have none
  CHECK(sum.outer_slope(0) == 1.0);
  CHECK(sum.outer_slope(2) == 0.0);
  CHECK(sum.outer_slope(4) == -1.0);
  sum = at;
  CHECK(sum.outer_slope(4) == 0.0);
}

namespace {

/// Second derivatives of the sum of A xi1 + b, by differences of its tangent's sum.
MatrixXd differenced(const sepcal::BlockModel& model, const sepcal::Block& block,
                     const VectorXd& xi2, const VectorXd& xi1) {
  const Index n_1 = xi1.size();
  const Index n_2 = xi2.size();
  const auto slope = [&](const VectorXd& x) -> VectorXd {
    MatrixXd rows(model.tables().n_z() * static_cast<Index>(block.rows), n_1 + n_2 + 1);
    model.evaluate(block, x.data(), sepcal::values_of(xi1), nullptr, rows);
    return rows.middleCols(n_1, n_2).colwise().sum();
  };
  MatrixXd hessian(n_2, n_2);
  for (Index k = 0; k < n_2; ++k) {
    constexpr double h = 1e-5;
    VectorXd above = xi2;
    VectorXd below = xi2;
    above[k] += h;
    below[k] -= h;
    hessian.col(k) = (slope(above) - slope(below)) / (2 * h);
  }
  return hessian;
}

void check_second_derivatives(const sepcal::BlockModel& model, const sepcal::Record& record,
                              const VectorXd& xi2, const VectorXd& xi1) {
  const auto inputs = sepcal::test::block_inputs(model, record);
  const sepcal::Block block{inputs.pointers, record.length(), 0, true};
  MatrixXd sum = MatrixXd::Ones(xi2.size(), xi2.size());
  REQUIRE(model.add_second_derivatives(block, xi2.data(), sepcal::values_of(xi1), sum));
  const MatrixXd expected = differenced(model, block, xi2, xi1);
  const MatrixXd given = sum - MatrixXd::Ones(xi2.size(), xi2.size());
  CHECK((given - expected).norm() < 1e-6 * (1.0 + expected.norm()));
  CHECK((given - given.transpose()).norm() < 1e-10 * (1.0 + given.norm()));
}

}  // namespace

TEST_CASE("all models give their second derivatives, and add them") {
  for (const auto& simulated : sepcal::test::simulate_all(50)) {
    CAPTURE(simulated.name);
    check_second_derivatives(*simulated.model, simulated.record, simulated.xi2, simulated.xi1);
  }
  sepcal::test::Draws draws(3);
  sepcal::Record record;
  for (const char* axis : {"mx", "my", "mz"}) record.add(axis, draws.uniform_column(40, -40, 40));
  for (const char* port : {"scale", "axis_scale_x", "axis_scale_y", "axis_scale_z"}) {
    record.add(port, std::vector<double>(40, 0.0));
  }
  VectorXd xi2(9);
  xi2 << 0.05, -0.04, 0.1, 0.02, 0.01, -0.03, 3.0, -5.0, 8.0;
  const auto field = sepcal::block_model(sepcal::AttitudeIndependentMagnetometer{50.0, 0.5});
  check_second_derivatives(*field, record, xi2, VectorXd(0));

  sepcal::Record air;
  for (const char* axis : {"vn", "ve", "vd"}) air.add(axis, draws.uniform_column(40, 10, 30));
  for (const char* port : {"airspeed_scale", "airspeed_bias", "pressure_offset"}) {
    air.add(port, std::vector<double>(40, 0.0));
  }
  air.add("rho", std::vector<double>(40, 1.2));
  const auto tube = sepcal::block_model(sepcal::PitotStatic{});
  check_second_derivatives(*tube, air, Eigen::Vector3d(3, -2, 0.5), Eigen::Vector2d(0.95, 0.5));
}

}  // namespace nested_dual_test
