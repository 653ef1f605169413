// SPDX-License-Identifier: BSD-3-Clause
// Which ends of descents are one minimum, and their order, for double wells in closed form.
#include "estimation/minima.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "estimation/problem.hpp"
#include "formula_objective.hpp"

namespace minima_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;
using sepcal::FitOptions;
using sepcal::infinity;
using sepcal::estimation::Descent;
using sepcal::estimation::describe_flat_directions;
using sepcal::estimation::describe_other_minima;
using sepcal::estimation::find_minima;
using sepcal::estimation::half_widths;
using sepcal::estimation::IsKnown;
using sepcal::estimation::Problem;
using sepcal::test::FormulaObjective;
using sepcal::test::Unasked;

namespace {

VectorXd number(double x) { return VectorXd::Constant(1, x); }

FitOptions one_parameter() {
  FitOptions options;
  options.fix = {{"y", 0.0}};
  return options;
}

/// S = (x^2 - 1)^2 + t^2 (x + 1)^2 + 1. Its slope is (x + 1) (4 x (x - 1) + 2 t^2): minima at -1
/// and (1 + sqrt(1 - 2 t^2)) / 2, the pass at (1 - sqrt(1 - 2 t^2)) / 2.
struct DoubleWell {
  double t = 0.2;
  bool mirrored = false;
  Unasked unasked = {};

  double sign() const { return mirrored ? -1.0 : 1.0; }
  double left() const { return -sign(); }
  double right() const { return sign() * 0.5 * (1.0 + std::sqrt(1.0 - 2.0 * t * t)); }
  double pass() const { return sign() * 0.5 * (1.0 - std::sqrt(1.0 - 2.0 * t * t)); }
  double square(double x) const {
    const double u = sign() * x;
    return (u * u - 1.0) * (u * u - 1.0) + t * t * (u + 1.0) * (u + 1.0) + 1.0;
  }

  /// Samples 0.1 apart; descents that stop 1e-3 short of the well that they begin in. Of
  /// `measurements`, two are spent on parameters: a rise of S / (measurements - 2) is noticed.
  std::vector<Descent> find(double measurements, FitOptions options = one_parameter()) const {
    FormulaObjective objective(unasked, 3, 1, [this](const VectorXd& x, VectorXd& r, MatrixXd& J) {
      r << x[0] * x[0] - 1.0, t * (sign() * x[0] + 1.0), 1.0;
      J << 2.0 * x[0], t * sign(), 0.0;
      return true;
    });
    const Problem problem(unasked.model(), options);
    const MatrixXd samples = RowVectorXd::LinSpaced(41, -2.0, 2.0);
    VectorXd trace(samples.cols());
    for (Index s = 0; s < trace.size(); ++s) trace[s] = square(samples(0, s));
    return find_minima(objective, problem, samples, trace, MatrixXd(1, 0), measurements,
                       [&](const VectorXd& x, const IsKnown&, double) {
                         const bool goes_left = sign() * x[0] < sign() * pass();
                         const VectorXd end = number((goes_left ? left() : right()) + 1e-3);
                         return Descent{end, square(end[0]), true, false, 1};
                       });
  }
};

}  // namespace

TEST_CASE("two wells are two minima, refined, the lower one first, whichever side it is on") {
  for (const bool mirrored : {false, true}) {
    const DoubleWell wells{.mirrored = mirrored};
    const auto minima = wells.find(100);
    REQUIRE(minima.size() == 2);
    CHECK(minima[0].x[0] == Approx(wells.left()).epsilon(1e-9));
    CHECK(minima[1].x[0] == Approx(wells.right()).epsilon(1e-9));
    CHECK(minima[0].square == Approx(1.0).epsilon(1e-12));
    CHECK(minima[1].square == Approx(wells.square(wells.right())).epsilon(1e-12));
  }
}

TEST_CASE(
    "a pass that the record can't tell from the higher well joins them, the lower one stays") {
  // The pass is 0.89 above the higher well; a rise of S_min / (measurements - 2) = 1 is not
  // noticed, of 1 / 2 it is.
  for (const bool mirrored : {false, true}) {
    const DoubleWell wells{.mirrored = mirrored};
    const double rise = wells.square(wells.pass()) - wells.square(wells.right());
    REQUIRE(rise > 0.5);
    REQUIRE(rise < 1.0);
    CHECK(wells.find(4).size() == 2);
    const auto joined = wells.find(3);
    REQUIRE(joined.size() == 1);
    CHECK(joined[0].x[0] == Approx(wells.left()).epsilon(1e-9));
  }
}

TEST_CASE("twins are both kept") {
  const DoubleWell wells{.t = 0.0};
  const auto minima = wells.find(100);
  REQUIRE(minima.size() == 2);
  CHECK(minima[0].square == Approx(minima[1].square).epsilon(1e-12));
  CHECK(minima[0].x[0] * minima[1].x[0] == Approx(-1.0).epsilon(1e-9));
}

TEST_CASE("no more descents than were asked for, from the lowest basin") {
  FitOptions options = one_parameter();
  options.descents = 1;
  const DoubleWell wells;
  const auto minima = wells.find(100, options);
  REQUIRE(minima.size() == 1);
  CHECK(minima[0].x[0] == Approx(-1.0).epsilon(1e-9));
}

TEST_CASE("a descent that ends at no finite cost is no minimum") {
  const DoubleWell wells;
  FormulaObjective objective(wells.unasked, 1, 1,
                             [](const VectorXd&, VectorXd&, MatrixXd&) { return false; });
  const FitOptions options = one_parameter();
  const Problem problem(wells.unasked.model(), options);
  const MatrixXd samples = RowVectorXd::LinSpaced(5, -2.0, 2.0);
  const auto lost = [](const VectorXd& x, const IsKnown&, double) {
    return Descent{x, infinity, false, false, 0};
  };
  CHECK(find_minima(objective, problem, samples, VectorXd::Ones(5), MatrixXd(1, 0), 100, lost)
            .empty());
}

TEST_CASE(
    "lengths are half the bounds, or two standard deviations of what is sampled if that is less") {
  const Unasked unasked;
  FitOptions options;
  options.bounds["x"] = {-3.0, 7.0};
  options.bounds["y"] = {-infinity, infinity};
  options.sampling_distribution["x"] = {0.0, 10.0};
  options.sampling_distribution["y"] = {0.0, 0.4};
  const Problem problem(unasked.model(), options);
  CHECK(half_widths(problem) == Eigen::Vector2d(5.0, 0.8));
}

TEST_CASE("a direction is flat where half the bounds move the fit by less than two errors") {
  // r = (g (x - 0.3 y), 1), half widths of 2: the singular value along y - 0.3 x is zero, along
  // the other g 2 sqrt(1.09), against two standard errors of sqrt(1 / 100).
  const Unasked unasked;
  const FitOptions options;
  const Problem problem(unasked.model(), options);
  const double edge = 0.2 / (2.0 * std::sqrt(1.09));
  const auto count = [&](double g) {
    FormulaObjective objective(unasked, 2, 2, [g](const VectorXd& x, VectorXd& r, MatrixXd& J) {
      r << g * (x[0] - 0.3 * x[1]), 1.0;
      J << g, -0.3 * g, 0.0, 0.0;
      return true;
    });
    return describe_flat_directions(objective, problem, Eigen::Vector2d::Zero(), 103).size();
  };
  CHECK(count(1.01 * edge) == 1);
  CHECK(count(0.99 * edge) == 2);
}

TEST_CASE("another minimum is spoken of where its residuals are less than twice as large") {
  const Unasked unasked;
  const FitOptions options;
  const Problem problem(unasked.model(), options);  // x, y
  const auto at = [](double x, double y, double trace_r) {
    return sepcal::LocalMinimum{Eigen::Vector2d(x, y), trace_r};
  };
  CHECK(describe_other_minima(problem, {}).empty());
  CHECK(describe_other_minima(problem, {at(1, 2, 0.25)}).empty());
  CHECK(describe_other_minima(problem, {at(1, 2, 0.25), at(3, 4, 1.01)}).empty());
  CHECK(describe_other_minima(problem, {at(1, 2, 0.25), at(-3.14159, 40, 0.36)}) ==
        "another minimum lies at x -3.14, y 40, where residuals are 1.2 times as large");
  CHECK(describe_other_minima(problem, {at(1, 2, 0.25), at(3, 4, 0.36), at(5, 6, 0.5)})
            .ends_with("1.2 times as large, and 1 more (see stage_one)"));
}

}  // namespace minima_test
