// SPDX-License-Identifier: BSD-3-Clause
// Angles without jumps of a whole turn.
#pragma once

#include <cmath>
#include <vector>

namespace sepcal::checks {

/// What is no number stays where it is.
inline void unwrap(std::vector<double>& angles, double turn) {
  double before = std::nan("");
  for (double& angle : angles) {
    if (!std::isfinite(angle)) continue;
    if (std::isfinite(before)) {
      const double turns = std::round((angle - before) / turn);
      angle -= turns * turn;  // nothing, bit for bit, where there is no jump
    }
    before = angle;
  }
}

}  // namespace sepcal::checks
