// SPDX-License-Identifier: BSD-3-Clause
// A program with a fault, which the board has to trap.
#include "link.hpp"

void fly() {
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  x[target::read_count()] = 1.0;  // beyond its end
  target::write_all(x);
}
