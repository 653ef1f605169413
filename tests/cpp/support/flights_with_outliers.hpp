// SPDX-License-Identifier: BSD-3-Clause
// Records in which every twentieth reading is far off.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "sepcal/record.hpp"
#include "simulated_records.hpp"

namespace sepcal::test {

inline constexpr std::array outliers_truth{0.3, 0.5, 0.2};  // a, c, b

/// Scalar example 1, 200 rows, noise of 0.1; every twentieth reading is off by 30 of these, up or,
/// where `both_ways`, up or down.
inline Record simulate_with_outliers(std::uint64_t seed, bool both_ways) {
  Draws draws(seed);
  std::vector<double> eta = draws.uniform_column(200, 0.0, 2.0 * std::numbers::pi);
  std::vector<double> z;
  for (std::size_t k = 0; k < eta.size(); ++k) {
    double value =
        (1.0 + outliers_truth[0]) * std::cos(eta[k] + outliers_truth[2]) + outliers_truth[1];
    value += 0.1 * draws.normal();
    const double sign = both_ways && draws.uniform(-1.0, 1.0) < 0.0 ? -1.0 : 1.0;
    if (k % 20 == 7) value += 3.0 * sign;
    z.push_back(value);
  }
  Record record;
  record.add("eta", std::move(eta)).add("z", std::move(z));
  return record;
}

}  // namespace sepcal::test
