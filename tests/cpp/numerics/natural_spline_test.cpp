// SPDX-License-Identifier: BSD-3-Clause
// Natural cubic splines against closed forms and against the defining equations solved densely.
#include "sepcal/detail/natural_spline.hpp"

#include <ceres/jet.h>
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "numerics/decompositions.hpp"
#include "sepcal/error.hpp"
#include "simulated_records.hpp"

namespace natural_spline_test {

using doctest::Approx;
using doctest::Contains;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Error;
using sepcal::NaturalSpline;
using sepcal::SplineBasis;

namespace {

const std::vector<double> uneven{-5.0, -3.2, 0.1, 0.4, 2.0, 7.0};
const std::vector<double> heights{1.0, -2.0, 0.5, 3.0, 2.5, -1.0};

/// The spline as 4 unknown coefficients an interval, from the conditions that define it: values at
/// both ends, equal slopes and curvatures inside, no curvature at the ends.
class DenseSpline {
 public:
  DenseSpline(std::vector<double> x, const std::vector<double>& y) : x_(std::move(x)) {
    const auto pieces = static_cast<Index>(x_.size()) - 1;
    MatrixXd M = MatrixXd::Zero(4 * pieces, 4 * pieces);
    VectorXd right = VectorXd::Zero(4 * pieces);
    Index row = 0;
    for (Index i = 0; i < pieces; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double h = x_[k + 1] - x_[k];
      M(row, 4 * i) = 1;
      right[row++] = y[k];
      M.row(row).segment<4>(4 * i) << 1, h, h * h, h * h * h;
      right[row++] = y[k + 1];
      if (i + 1 == pieces) continue;
      M.row(row).segment<4>(4 * i) << 0, 1, 2 * h, 3 * h * h;
      M(row++, 4 * i + 5) = -1;
      M.row(row).segment<4>(4 * i) << 0, 0, 2, 6 * h;
      M(row++, 4 * i + 6) = -2;
    }
    const double h = x_.back() - x_[x_.size() - 2];
    M(row++, 2) = 1;
    M.row(row).tail<4>() << 0, 0, 2, 6 * h;
    coefficients_ = M.fullPivLu().solve(right);
  }

  NaturalSpline::Value at(double x) const {
    std::size_t i = 0;
    while (i + 2 < x_.size() && x > x_[i + 1]) ++i;
    const auto c = coefficients_.segment<4>(static_cast<Index>(4 * i));
    const double t = x - x_[i];
    return {c[0] + t * (c[1] + t * (c[2] + t * c[3])), c[1] + t * (2 * c[2] + 3 * t * c[3]),
            2 * c[2] + 6 * t * c[3]};
  }

 private:
  std::vector<double> x_;
  VectorXd coefficients_;
};

void check_equal(const NaturalSpline::Value& a, const NaturalSpline::Value& b, double tolerance) {
  CHECK(std::abs(a.value - b.value) < tolerance);
  CHECK(std::abs(a.slope - b.slope) < tolerance);
  CHECK(std::abs(a.curvature - b.curvature) < tolerance);
}

}  // namespace

TEST_CASE("value, slope and curvature are those of the defining equations solved densely") {
  const NaturalSpline spline(uneven, heights);
  const DenseSpline expected(uneven, heights);
  sepcal::test::Draws draws(301);
  for (int i = 0; i < 200; ++i) {
    const double x = draws.uniform(-5, 7);
    CAPTURE(x);
    check_equal(spline.at(x), expected.at(x), 1e-11);
  }
  for (std::size_t k = 0; k < uneven.size(); ++k) {
    CHECK(spline.at(uneven[k]).value == Approx(heights[k]).epsilon(1e-14));
  }
}

TEST_CASE("three knots by hand: the middle curvature is 3 (y0 - 2 y1 + y2) / 2 for unit steps") {
  const NaturalSpline spline({0, 1, 2}, {0, 1, 0});
  CHECK(spline.at(1).curvature == Approx(-3.0));
  CHECK(spline.at(0.5).value == Approx(0.6875));  // 1.5 x - 0.5 x^3
  CHECK(spline.at(0.5).slope == Approx(1.125));
  CHECK(spline.at(1).slope == Approx(0.0));
}

TEST_CASE("it is twice continuously differentiable across every knot") {
  const NaturalSpline spline(uneven, heights);
  for (const double knot : uneven) {
    CAPTURE(knot);
    const double step = 1e-9;
    check_equal(spline.at(knot - step), spline.at(knot + step), 1e-6);
  }
}

TEST_CASE("beyond its ends it is a straight line, without curvature") {
  const NaturalSpline spline(uneven, heights);
  for (const double end : {uneven.front(), uneven.back()}) {
    const auto at_end = spline.at(end);
    CHECK(std::abs(at_end.curvature) < 1e-14);
    for (const double beyond : {1e-3, 2.0, 100.0}) {
      const double x = end < 0 ? end - beyond : end + beyond;
      const auto outside = spline.at(x);
      CHECK(outside.value == Approx(at_end.value + (x - end) * at_end.slope).epsilon(1e-13));
      CHECK(outside.slope == at_end.slope);
      CHECK(outside.curvature == 0.0);
    }
  }
}

TEST_CASE("a straight line and two knots stay straight") {
  const NaturalSpline line({0, 0.3, 1, 5}, {1, 1.6, 3, 11});
  for (const double x : {-1.0, 0.2, 0.7, 4.0, 9.0})
    check_equal(line.at(x), {1 + 2 * x, 2, 0}, 1e-12);
  const NaturalSpline two({1, 3}, {5, 1});
  for (const double x : {0.0, 2.5, 4.0}) check_equal(two.at(x), {7 - 2 * x, -2, 0}, 1e-13);
}

TEST_CASE("the error of an interpolated sine falls with the fourth power of the interval") {
  // Over whole half waves a sine has no curvature at its ends: it is natural by itself.
  const auto error = [](int intervals) {
    const double pi = std::acos(-1.0);
    std::vector<double> x = sepcal::even_knots(0.0, 2 * pi, intervals + 1);
    std::vector<double> y;
    for (const double t : x) y.push_back(std::sin(t));
    const NaturalSpline spline(x, y);
    double largest = 0;
    for (int k = 0; k <= 1000; ++k) {
      const double t = 2 * pi * k / 1000;
      largest = std::max(largest, std::abs(spline.at(t).value - std::sin(t)));
    }
    return largest;
  };
  CHECK(error(20) < 5.0 / 384.0 * std::pow(2 * std::acos(-1.0) / 20, 4));
  CHECK(error(20) / error(40) == Approx(16.0).epsilon(0.1));
}

TEST_CASE("a walk with a hint finds what a search finds, from any hint") {
  const NaturalSpline spline(uneven, heights);
  sepcal::test::Draws draws(302);
  std::size_t hint = 0;
  for (int i = 0; i < 300; ++i) {
    const double x = draws.uniform(-8, 10);
    if (i % 7 == 0) hint = static_cast<std::size_t>(i);  // beyond the last interval as well
    check_equal(spline.at(x, hint), spline.at(x), 1e-12);
    CHECK(hint <= 4);
  }
}

TEST_CASE("even knots begin and end exactly where they should") {
  const std::vector<double> knots = sepcal::even_knots(-0.1, 0.7, 5);
  REQUIRE(knots.size() == 5);
  CHECK(knots.front() == -0.1);
  CHECK(knots.back() == 0.7);
  for (std::size_t i = 1; i < 5; ++i) CHECK(knots[i] - knots[i - 1] == Approx(0.2));
}

TEST_CASE("a basis function is the spline through a one at its own knot and zeros at the others") {
  const SplineBasis basis(uneven);
  REQUIRE(basis.functions() == 5);
  Eigen::RowVectorXd values(5);
  for (std::size_t j = 1; j < uneven.size(); ++j) {
    std::vector<double> unit(uneven.size(), 0.0);
    unit[j] = 1.0;
    const NaturalSpline spline(uneven, unit);
    for (double x = -9.0; x < 12.0; x += 0.37) {
      CAPTURE(x);
      basis.evaluate(x, values);
      CHECK(std::abs(values[static_cast<Index>(j) - 1] - spline.at(x).value) < 1e-12);
    }
    for (const double knot : uneven) {
      basis.evaluate(knot, values);
      CHECK(std::abs(values[static_cast<Index>(j) - 1] - spline.at(knot).value) < 1e-14);
    }
  }
}

TEST_CASE("knots that are too few, not increasing or without a value each are refused") {
  CHECK_THROWS_WITH_AS(NaturalSpline({1}, {1}), Contains("has 1 knots; it needs at least 2"),
                       Error);
  CHECK_THROWS_WITH_AS(SplineBasis({1, 2}), Contains("has 2 knots; it needs at least 3"), Error);
  CHECK_THROWS_WITH_AS(NaturalSpline({0, 1, 1}, {0, 0, 0}),
                       Contains("must increase; knot 3 is not above the one before it"), Error);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS(NaturalSpline({0, nan, 1}, {0, 0, 0}), Contains("knot 2"), Error);
  CHECK_THROWS_WITH_AS(NaturalSpline({0, HUGE_VAL}, {0, 0}), Contains("knot 2"), Error);
  CHECK_THROWS_WITH_AS(NaturalSpline({0, 1}, {0}), Contains("one value at each knot"), Error);
  CHECK_THROWS_WITH_AS(sepcal::even_knots(0, 1, 1), Contains("1 knots"), Error);
  CHECK_THROWS_WITH_AS(sepcal::even_knots(2, 2, 4), Contains("must increase"), Error);
}

TEST_CASE("a function alone is that of the row, with its slope in dual numbers") {
  using Jet = ceres::Jet<double, 1>;
  const SplineBasis basis(uneven);
  Eigen::RowVectorXd row(basis.functions());
  Eigen::RowVectorXd ahead(basis.functions());
  Eigen::RowVectorXd behind(basis.functions());
  constexpr double step = 1e-6;
  for (double x = -9.0; x < 10.0; x += 0.37) {
    CAPTURE(x);
    basis.evaluate(x, row);
    basis.evaluate(x + step, ahead);
    basis.evaluate(x - step, behind);
    for (int j = 0; j < basis.functions(); ++j) {
      CHECK(basis.value(j, x) == Approx(row[j]).epsilon(1e-12));
      const Jet at = basis.value(j, Jet(x, 0));
      CHECK(at.a == Approx(row[j]).epsilon(1e-12));
      CHECK(std::abs(at.v[0] - (ahead[j] - behind[j]) / (2.0 * step)) < 1e-7);
    }
  }
}

}  // namespace natural_spline_test
