// SPDX-License-Identifier: BSD-3-Clause
// A = Q S, a rotation after a symmetric positive definite matrix.
#pragma once

#include <Eigen/Core>

namespace sepcal::exporting {

struct Polar {
  Eigen::Matrix3d rotation;
  Eigen::Matrix3d symmetric;
  double angle = 0.0;  // rad, that the rotation turns by
};

/// Of an invertible matrix with a positive determinant.
Polar polar(const Eigen::Matrix3d& A);

}  // namespace sepcal::exporting
