// SPDX-License-Identifier: BSD-3-Clause
// min |R x - q| within a box, for the few columns of a compressed problem: the active-set method of
// Stark & Parker (Bounded-Variable Least-Squares, 1995).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "minimise.hpp"

namespace sepcal {

struct BoundedSolution {
  Eigen::VectorXd x;         // n, within the box
  std::vector<bool> active;  // n: x lies on a bound and |R x - q| would fall beyond it
};

/// R is m x n, q has m entries; zero must lie within the box. Where R does not see a combination,
/// its step is of least norm in columns of unit length.
BoundedSolution solve_bounded(const Eigen::MatrixXd& R, const Eigen::VectorXd& q, const Box& box);

}  // namespace sepcal
