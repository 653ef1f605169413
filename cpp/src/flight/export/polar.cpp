// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/polar.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace sepcal::exporting {

Polar polar(const Eigen::Matrix3d& A) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d Q = svd.matrixU() * svd.matrixV().transpose();
  const Eigen::Matrix3d S =
      svd.matrixV() * svd.singularValues().asDiagonal() * svd.matrixV().transpose();
  return {.rotation = Q, .symmetric = S, .angle = Eigen::AngleAxisd(Q).angle()};
}

}  // namespace sepcal::exporting
