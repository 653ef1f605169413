// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/bounded_least_squares.hpp"
#include "numerics/decompositions.hpp"
#include "sepcal/detail/quantity.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

namespace bounded_least_squares_test {

using namespace sepcal;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// The least |R x - q| over a box, by trying every choice of free, lower and upper for every
/// column.
double exhaustive_minimum(const MatrixXd& R, const VectorXd& q, const numerics::Box& box) {
  const Index n = R.cols();
  double least = infinity;
  const auto choices = static_cast<int>(std::pow(3, n));
  for (int choice = 0; choice < choices; ++choice) {
    std::vector<Index> free;
    VectorXd x = VectorXd::Zero(n);
    int digits = choice;
    for (Index k = 0; k < n; ++k, digits /= 3) {
      if (digits % 3 == 0) free.push_back(k);
      if (digits % 3 == 1) x[k] = box.lower[k];
      if (digits % 3 == 2) x[k] = box.upper[k];
    }
    if (!x.allFinite()) continue;
    if (!free.empty()) {
      x(free) = MatrixXd(R(Eigen::all, free)).colPivHouseholderQr().solve(VectorXd(q - R * x));
    }
    const bool inside =
        ((x - box.lower).array() >= -1e-12).all() && ((box.upper - x).array() >= -1e-12).all();
    if (inside) least = std::min(least, (R * x - q).norm());
  }
  return least;
}

}  // namespace

TEST_CASE("without a bound in the way the solution is that of least squares") {
  MatrixXd R(3, 2);
  R << 2, 1, 0, 3, 1, -1;
  const VectorXd q = (VectorXd(3) << 1, 2, 3).finished();
  const numerics::Box box{VectorXd::Constant(2, -10), VectorXd::Constant(2, 10)};
  const numerics::BoundedSolution solution = numerics::solve_bounded(R, q, box);
  CHECK((solution.x - R.colPivHouseholderQr().solve(q)).norm() < 1e-14);
  CHECK(solution.active == std::vector<bool>{false, false});
}

TEST_CASE("in random boxes the solution is as good as the best of all choices of active bounds") {
  std::mt19937_64 generator(3);
  const auto draw = [&] { return static_cast<double>(generator() >> 11U) * 0x1p-52 - 1.0; };
  for (int trial = 0; trial < 300; ++trial) {
    const Index n = 1 + trial % 5;
    MatrixXd R(n + 1, n);
    VectorXd q(n + 1);
    for (double& value : R.reshaped()) value = draw();
    for (double& value : q) value = 3.0 * draw();
    numerics::Box box{VectorXd(n), VectorXd(n)};
    for (Index k = 0; k < n; ++k) {
      box.lower[k] = trial % 7 == 0 ? 0.0 : -std::abs(draw());  // zero itself may be a bound
      box.upper[k] = trial % 11 == 0 ? infinity : std::abs(draw());
    }
    const numerics::BoundedSolution solution = numerics::solve_bounded(R, q, box);
    CHECK(((solution.x - box.lower).array() >= 0).all());
    CHECK(((box.upper - solution.x).array() >= 0).all());
    CHECK((R * solution.x - q).norm() ==
          doctest::Approx(exhaustive_minimum(R, q, box)).epsilon(1e-10));
    // Off the bounds nothing pulls; at an active one the pull points outwards.
    const VectorXd pull = R.transpose() * (q - R * solution.x);
    for (Index k = 0; k < n; ++k) {
      if (!solution.active[static_cast<std::size_t>(k)]) {
        CHECK(std::abs(pull[k]) < 1e-10);
      } else if (solution.x[k] == box.lower[k]) {
        CHECK(pull[k] <= 1e-10);
      } else {
        CHECK(solution.x[k] == box.upper[k]);
        CHECK(pull[k] >= -1e-10);
      }
    }
  }
}

TEST_CASE("a column of zeros takes no step") {
  MatrixXd R(2, 2);
  R << 1, 0, 0, 0;
  const VectorXd q = (VectorXd(2) << 2, 0).finished();
  const numerics::Box box{VectorXd::Constant(2, -1), VectorXd::Constant(2, 1)};
  const numerics::BoundedSolution solution = numerics::solve_bounded(R, q, box);
  CHECK(solution.x == (VectorXd(2) << 1, 0).finished());
  CHECK(solution.active[0]);
}

}  // namespace bounded_least_squares_test
