// SPDX-License-Identifier: BSD-3-Clause
// Symmetric matrices; of 3 x 3 their six entries, in the order xx, yy, zz, xy, xz, yz.
#pragma once

#include <Eigen/Core>

namespace sepcal::numerics {

inline Eigen::Matrix3d symmetric(const Eigen::Vector3d& diagonal,
                                 const Eigen::Vector3d& off_diagonal) {
  Eigen::Matrix3d matrix;
  matrix << diagonal[0], off_diagonal[0], off_diagonal[1],  //
      off_diagonal[0], diagonal[1], off_diagonal[2],        //
      off_diagonal[1], off_diagonal[2], diagonal[2];
  return matrix;
}

inline Eigen::Vector<double, 6> entries(const Eigen::Matrix3d& S) {
  return {S(0, 0), S(1, 1), S(2, 2), S(0, 1), S(0, 2), S(1, 2)};
}

/// (M + M') / 2: what is symmetric but for rounding, to the last bit.
inline Eigen::MatrixXd symmetric_part(const Eigen::MatrixXd& M) {
  return 0.5 * (M + M.transpose());
}

}  // namespace sepcal::numerics
