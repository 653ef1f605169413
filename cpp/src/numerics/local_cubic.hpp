// SPDX-License-Identifier: BSD-3-Clause
// Smoothed differentiation: the slope of a least-squares cubic over a window of time.
#pragma once

#include <span>
#include <vector>

namespace sepcal::numerics {

/// How few rows any window holds: a cubic through fewer than five smooths nothing.
std::size_t fewest_rows(std::span<const double> time, double window);

/// d values / d time at every row, by the cubic over the `window` (in time's unit) about it, which
/// at the ends lies to one side. `time` increases. NaN where a window holds a NaN or fewer than
/// four rows.
std::vector<double> differentiate_locally(std::span<const double> time,
                                          std::span<const double> values, double window);

}  // namespace sepcal::numerics
