// SPDX-License-Identifier: BSD-3-Clause
#include "model/soft_iron_and_scale.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "numerics/symmetric.hpp"

namespace sepcal::model {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using numerics::entries;
using numerics::symmetric;

std::optional<SoftIronAndScale> split_shape(const Matrix3d& shape) {
  constexpr int most_steps = 50;
  constexpr double small_step = 1e-12;  // of the largest unknown, which are of order one
  const double unit = shape.diagonal().mean();
  const Matrix3d S = shape / unit;
  Vector3d d = S.diagonal();  // scale factors squared
  Vector3d alpha = Vector3d::Zero();
  for (int step = 0; step < most_steps; ++step) {
    const Matrix3d A = symmetric(Vector3d::Ones(), alpha);
    const Matrix3d AD = A * d.asDiagonal();
    Eigen::Matrix<double, 6, 6> jacobian;
    for (Index k = 0; k < 3; ++k) {
      jacobian.col(k) = entries(A.col(k) * A.col(k).transpose());
      const Matrix3d by_alpha = symmetric(Vector3d::Zero(), Vector3d::Unit(k)) * AD.transpose();
      jacobian.col(3 + k) = entries(by_alpha + by_alpha.transpose());
    }
    const Eigen::Vector<double, 6> change =
        jacobian.fullPivLu().solve(entries(S - AD * A.transpose()));
    if (!change.allFinite()) return std::nullopt;
    d += change.head<3>();
    alpha += change.tail<3>();
    if (change.cwiseAbs().maxCoeff() > small_step * std::max(1.0, d.maxCoeff())) continue;
    if (!(d.minCoeff() > 0)) return std::nullopt;
    return SoftIronAndScale{(unit * d).cwiseSqrt(), alpha};
  }
  return std::nullopt;
}

}  // namespace sepcal::model
