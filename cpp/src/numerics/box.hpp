// SPDX-License-Identifier: BSD-3-Clause
// The bounds of n numbers at once.
#pragma once

#include <Eigen/Core>

namespace sepcal::numerics {

struct Box {
  Eigen::VectorXd lower;  // n
  Eigen::VectorXd upper;  // n

  Eigen::VectorXd clip(const Eigen::VectorXd& x) const { return x.cwiseMax(lower).cwiseMin(upper); }
};

}  // namespace sepcal::numerics
