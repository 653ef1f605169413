// SPDX-License-Identifier: BSD-3-Clause
// min |R x - q| within a box, for the columns of a compressed problem: the active-set method of
// Stark & Parker (Bounded-Variable Least-Squares, 1995).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "numerics/box.hpp"

namespace sepcal::numerics {

struct BoundedSolution {
  Eigen::VectorXd x;         // n, within the box
  std::vector<bool> active;  // n: x lies on a bound and |R x - q| would fall beyond it
};

/// |A x - q|^2 as the active-set method asks about it, whatever the shape in which A is kept.
class LeastSquares {
 public:
  LeastSquares() = default;
  LeastSquares(const LeastSquares&) = delete;
  LeastSquares& operator=(const LeastSquares&) = delete;
  virtual ~LeastSquares() = default;

  /// Of A's columns (n).
  virtual Eigen::VectorXd lengths() const = 0;

  /// A'(q - A x), half the negative gradient at x.
  virtual Eigen::VectorXd pull(const Eigen::VectorXd& x) const = 0;

  /// The minimum over the parameters `free`, the others as they are in x. Where A does not see a
  /// combination, the shortest such step in columns of unit length.
  virtual Eigen::VectorXd minimise_over(const std::vector<Eigen::Index>& free,
                                        Eigen::VectorXd x) const = 0;
};

/// Zero must lie within the box.
BoundedSolution solve_bounded(const LeastSquares& problem, const Box& box);

/// R is m x n, q has m entries; zero must lie within the box. Where R does not see a combination,
/// its step is of least norm in columns of unit length.
BoundedSolution solve_bounded(const Eigen::MatrixXd& R, const Eigen::VectorXd& q, const Box& box);

}  // namespace sepcal::numerics
