// SPDX-License-Identifier: BSD-3-Clause
// The last digits of minima that are known in closed form, with and without a bound that holds.
#include "estimation/refine.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "formula_objective.hpp"

namespace refine_test {

using doctest::Approx;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;
using sepcal::infinity;
using sepcal::estimation::refine;
using sepcal::estimation::Refinement;
using sepcal::numerics::Box;
using sepcal::test::FormulaObjective;
using sepcal::test::Unasked;

namespace {

/// |q - R x|^2 + 7 with R = [2 1; 0 3], q = (4, 6): least at (1, 2).
FormulaObjective quadratic(const Unasked& unasked) {
  return {unasked, 3, 2, [](const VectorXd& x, VectorXd& r, MatrixXd& J) {
            r << 4.0 - 2.0 * x[0] - x[1], 6.0 - 3.0 * x[1], std::sqrt(7.0);
            J << -2.0, -1.0, 0.0, -3.0, 0.0, 0.0;
            return true;
          }};
}

VectorXd number(double x) { return VectorXd::Constant(1, x); }

const Vector2d ones = Vector2d::Ones();

}  // namespace

TEST_CASE("a quadratic ends where its gradient is zero, from anywhere") {
  const Unasked unasked;
  FormulaObjective objective = quadratic(unasked);
  const Box anywhere{Vector2d::Constant(-infinity), Vector2d::Constant(infinity)};
  const Box wide{Vector2d(-10.0, -10.0), Vector2d(10.0, 10.0)};
  for (const Box& box : {anywhere, wide}) {
    // The last start lies on two bounds from which the cost falls inwards.
    for (const Vector2d& start : {Vector2d(1.0, 2.0), Vector2d(5.0, -8.0), Vector2d(-10.0, 10.0)}) {
      const Refinement result = refine(objective, start, box, ones);
      CHECK(result.converged);
      CHECK((result.x - Vector2d(1.0, 2.0)).norm() < 1e-13);
      CHECK(result.at_bound == std::vector<bool>{false, false});
    }
  }
}

TEST_CASE("a bound that the minimum lies beyond holds its parameter, and the other one follows") {
  // y <= 1.2 holds; of x remains (4 - 1.2 - 2 x)^2, zero at 1.4.
  const Unasked unasked;
  FormulaObjective objective = quadratic(unasked);
  const Box box{Vector2d(-10.0, -10.0), Vector2d(10.0, 1.2)};
  for (const Vector2d& start : {Vector2d(0.0, 0.0), Vector2d(9.0, 1.2), Vector2d(0.0, 5.0)}) {
    const Refinement result = refine(objective, start, box, ones);
    CHECK(result.converged);
    CHECK(result.x[0] == Approx(1.4).epsilon(1e-13));
    CHECK(result.x[1] == 1.2);
    CHECK(result.at_bound == std::vector<bool>{false, true});
  }
}

TEST_CASE("Newton's steps take over where Gauss-Newton's don't contract") {
  // r = (x - 1e-3, 3 + x^2): half the gradient is 2 x^3 + 7 x - 1e-3, J'J = 1 + 4 x^2. At the root
  // the Hessian is 7 times J'J, so that Gauss-Newton's steps go six times too far.
  const Unasked unasked;
  FormulaObjective objective(unasked, 2, 1, [](const VectorXd& x, VectorXd& r, MatrixXd& J) {
    r << x[0] - 1e-3, 3.0 + x[0] * x[0];
    J << 1.0, 2.0 * x[0];
    return true;
  });
  double root = 1e-3 / 7.0;
  for (int i = 0; i < 5; ++i) root = (1e-3 - 2.0 * root * root * root) / 7.0;
  const Refinement result =
      refine(objective, number(0.01), {number(-5.0), number(5.0)}, number(1.0));
  CHECK(result.converged);
  CHECK(result.x[0] == Approx(root).epsilon(1e-7));
  CHECK_FALSE(result.at_bound[0]);
}

TEST_CASE("where no minimum is near, and where the model is not finite, the start comes back") {
  // r = (x, 3 - x^2) near its summit: J'J = 1 + 4 x^2 and a Hessian of -5 + 6 x^2.
  const Unasked unasked;
  FormulaObjective summit(unasked, 2, 1, [](const VectorXd& x, VectorXd& r, MatrixXd& J) {
    r << x[0], 3.0 - x[0] * x[0];
    J << 1.0, -2.0 * x[0];
    return std::abs(x[0]) < 0.5;  // and no further
  });
  const Refinement back = refine(summit, number(0.2), {number(-5.0), number(5.0)}, number(1.0));
  CHECK_FALSE(back.converged);
  CHECK(back.x[0] == 0.2);
  FormulaObjective nowhere(unasked, 1, 1,
                           [](const VectorXd&, VectorXd&, MatrixXd&) { return false; });
  const Refinement none = refine(nowhere, number(7.0), {number(-1.0), number(1.0)}, number(1.0));
  CHECK_FALSE(none.converged);
  CHECK(none.x[0] == 1.0);  // the start, clipped to the box
}

}  // namespace refine_test
