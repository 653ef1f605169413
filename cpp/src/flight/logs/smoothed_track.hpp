// SPDX-License-Identifier: BSD-3-Clause
// Velocity from positions: the path whose acceleration wanders as white jerk drives it, smoothed
// (Rauch, Tung & Striebel 1965). How much it wanders against the positions' noise is what makes
// the positions most likely.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace sepcal::logs {

struct SmoothedTrack {
  std::vector<double> position;  // m, at each fix
  std::vector<double> velocity;  // m/s
  double position_error = 0.0;   // m, the standard deviation of a fix
  double velocity_error = 0.0;   // m/s, rms of the smoothed velocity's standard deviations
};

/// One axis. `time` [s] rises within each part; `parts`: the first fix of each, and behind them
/// time.size(). A part of fewer than three fixes gets NaN.
SmoothedTrack smooth_track(std::span<const double> time, std::span<const double> position,
                           const std::vector<std::size_t>& parts);

}  // namespace sepcal::logs
