// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/basins.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace basins_test {

using namespace sepcal;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double infinity_depth = std::numeric_limits<double>::infinity();

MatrixXd row(std::initializer_list<double> values) {
  MatrixXd points(1, static_cast<Index>(values.size()));
  Index i = 0;
  for (const double value : values) points(0, i++) = value;
  return points;
}

VectorXd column(std::initializer_list<double> values) { return row(values).transpose(); }

}  // namespace

TEST_CASE("two valleys on a line are as deep as the pass between them is high") {
  // Two neighbours on either side; the pass between the minima 1 and 0 is two samples wide, at 5.
  const auto basins =
      numerics::find_basins(row({0, 1, 2, 3, 4, 5, 6, 7}), column({3, 1, 2, 5, 5.5, 4, 0, 6}));
  REQUIRE(basins.size() == 2);
  CHECK(basins[0].lowest == 6);
  CHECK(basins[0].depth == infinity_depth);
  CHECK(basins[1].lowest == 1);
  CHECK(basins[1].depth == 4.0);
}

TEST_CASE("a slope has one basin, wherever its samples stand") {
  const auto basins = numerics::find_basins(row({4, 2, 0, 3, 1}), column({8, 4, 0, 6, 2}));
  REQUIRE(basins.size() == 1);
  CHECK(basins[0].lowest == 2);
}

TEST_CASE("samples where the function is not defined join nothing") {
  const double undefined = infinity_depth;
  const auto basins = numerics::find_basins(
      row({0, 1, 2, 10, 11, 12, 13, 14, 20, 21, 22}),
      column({1, 0, 3, undefined, undefined, undefined, undefined, undefined, 4, 2, 5}));
  REQUIRE(basins.size() == 2);
  CHECK(basins[0].lowest == 1);
  CHECK(basins[1].lowest == 9);
}

TEST_CASE("a single sample is a basin") {
  const auto basins = numerics::find_basins(row({0.5}), column({2}));
  REQUIRE(basins.size() == 1);
  CHECK(basins[0].lowest == 0);
}

TEST_CASE("scatter within a narrow valley makes shallow basins, a second minimum a deep one") {
  // f = (1 - cos 2 pi x) / 2 + 20 (y - x)^2 on [-0.5, 1.5]: minima at (0, 0) and (1, 1), the pass
  // at (0.5, 0.5) one above them; samples stand about 0.08 apart, so that scatter across the valley
  // makes rises of about 0.1.
  std::mt19937_64 generator(7);
  MatrixXd points(2, 600);
  VectorXd values(600);
  for (Index s = 0; s < 600; ++s) {
    const auto draw = [&] { return static_cast<double>(generator() >> 11U) * 0x1p-53; };
    const double x = -0.5 + 2.0 * draw();
    const double y = -0.5 + 2.0 * draw();
    points.col(s) << x, y;
    values[s] = 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * x)) + 20.0 * (y - x) * (y - x);
  }
  const auto basins = numerics::find_basins(points, values);
  REQUIRE(basins.size() >= 2);
  const auto x_of = [&](std::size_t i) { return points(0, basins[i].lowest); };
  CHECK(std::min(x_of(0), x_of(1)) == doctest::Approx(0.0).epsilon(0.25));
  CHECK(std::max(x_of(0), x_of(1)) == doctest::Approx(1.0).epsilon(0.25));
  CHECK(basins[1].depth > 0.8);
  for (std::size_t i = 2; i < basins.size(); ++i) CHECK(basins[i].depth < basins[1].depth);
}

}  // namespace basins_test
