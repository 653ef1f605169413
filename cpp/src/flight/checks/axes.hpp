// SPDX-License-Identifier: BSD-3-Clause
// Axes that are swapped or turned round: which order and which signs agree best with a second
// measure of the same vector.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace sepcal::checks {

struct BetterAxes {
  std::string axes;        // "ve, -vn", in the place of the axes as logged; empty: none do
  double agreement = 0.0;  // of these, 1 in full
  double agreement_as_logged = 0.0;
};

/// `moving`: rows of north, east [m/s] and yaw [rad]. Agreement is the mean cosine of the angle
/// between the track over the ground and the yaw. Below 0.5, which no wind that a turn can be flown
/// in does, an order and signs of (vn, ve) are offered where they reach 0.85; below 0.3 it is said
/// that none do.
std::optional<BetterAxes> find_track_axes(const std::vector<std::array<double, 3>>& moving);

/// `read` and `truth`: the field in body axes, 3 x N each, or no truth. Agreement is the
/// correlation of all components together about their means, which hard iron does not touch. An
/// order and signs are offered where they reach 0.9, the log as it is does not, and they leave a
/// fifth of what it lacks.
std::optional<BetterAxes> find_field_axes(const Eigen::Matrix3Xd& read,
                                          const Eigen::Matrix3Xd& truth);

}  // namespace sepcal::checks
