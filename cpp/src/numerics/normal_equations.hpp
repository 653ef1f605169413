// SPDX-License-Identifier: BSD-3-Clause
// What columns G explain of a vector y by least squares, from their products alone.
#pragma once

#include <Eigen/Core>

namespace sepcal::numerics {

/// The sum of squares of y that columns explain, and how many directions they have.
struct ExplainedSquares {
  double square = 0.0;
  Eigen::Index directions = 0;
};

/// Of G'G = `square` and G'y = `product`, along the directions that columns of `lengths` (of 0: a
/// column that counts for nothing) leave open.
ExplainedSquares explained_squares(const Eigen::MatrixXd& square, const Eigen::VectorXd& product,
                                   const Eigen::VectorXd& lengths);

}  // namespace sepcal::numerics
