// SPDX-License-Identifier: BSD-3-Clause
// Few points that stand for many: a sum of w_i f(x_i) by Gauss's nodes and weights, exact where f
// is a polynomial (Golub & Welsch, Math. Comp. 23, 1969; the tridiagonal matrix by Lanczos).
#pragma once

#include <Eigen/Core>

namespace sepcal::numerics {

struct GaussRule {
  Eigen::VectorXd nodes;    // within the range of x
  Eigen::VectorXd weights;  // of the sign of w
};

/// Exact up to degree 2 count - 1, for points x (more than `count` different ones) with weights w
/// of one sign.
GaussRule gauss_rule(const Eigen::VectorXd& x, const Eigen::VectorXd& w, Eigen::Index count);

}  // namespace sepcal::numerics
