// SPDX-License-Identifier: BSD-3-Clause
// How one number spreads over units that each know it with an error of their own: y_i ~ N(mean, v_i
// + variance), by restricted maximum likelihood.
#pragma once

#include <vector>

namespace sepcal::fleet {

struct Spread {
  double mean = 0.0;
  double standard_error = 0.0;  // of the mean
  double variance = 0.0;        // between units, not below 0
};

/// At least two estimates, with variances above 0.
Spread find_spread(const std::vector<double>& estimates, const std::vector<double>& variances);

}  // namespace sepcal::fleet
