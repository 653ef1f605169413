// SPDX-License-Identifier: BSD-3-Clause
// C = C_alpha C_lambda from C C', all that readings without an attitude show of it.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace sepcal::model {

/// C_alpha C_lambda with (C_alpha C_lambda)(C_alpha C_lambda)' = S.
struct SoftIronAndScale {
  Eigen::Vector3d scale;      // 1 + lambda, positive
  Eigen::Vector3d soft_iron;  // alpha_xy, alpha_xz, alpha_yz
};

/// Newton's method on the six entries. Nothing where it does not converge to positive scale
/// factors: soft iron too strong for a unit diagonal.
std::optional<SoftIronAndScale> split_shape(const Eigen::Matrix3d& shape);

}  // namespace sepcal::model
