// SPDX-License-Identifier: BSD-3-Clause
// Attitude: the 3-2-1 Euler sequence from body axes (forward, right, down) to north-east-down.
#pragma once

#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/lanewise.hpp"

namespace sepcal {

/// C_b^n (3 x 3), v_n = C_b^n v_b; angles in rad (Eq. 39, whose printed entry (1,2) lacks
/// cos(psi)).
template <class T>
Eigen::Matrix<T, 3, 3> body_to_ned(const T& roll, const T& pitch, const T& yaw) {
  const auto [cr, sr] = cos_sin(roll);
  const auto [cp, sp] = cos_sin(pitch);
  const auto [cy, sy] = cos_sin(yaw);
  Eigen::Matrix<T, 3, 3> C;
  C << cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy,  //
      cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy,   //
      -sp, sr * cp, cr * cp;
  return C;
}

}  // namespace sepcal
