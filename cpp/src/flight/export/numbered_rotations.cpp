// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/numbered_rotations.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <numbers>

#include "flight/probes/mounting.hpp"

namespace sepcal::exporting {
namespace {

constexpr std::size_t no_multiple_of_45 = 38;  // roll 90, pitch 68, yaw 293

/// By number, in eighths of a turn.
struct Eighths {
  int roll;
  int pitch;
  int yaw;
};
constexpr std::array<Eighths, 41> by_number{{
    {0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {0, 0, 4}, {0, 0, 5}, {0, 0, 6},  // 0
    {0, 0, 7}, {4, 0, 0}, {4, 0, 1}, {4, 0, 2}, {4, 0, 3}, {0, 4, 0}, {4, 0, 5},  // 7
    {4, 0, 6}, {4, 0, 7}, {2, 0, 0}, {2, 0, 1}, {2, 0, 2}, {2, 0, 3}, {6, 0, 0},  // 14
    {6, 0, 1}, {6, 0, 2}, {6, 0, 3}, {0, 2, 0}, {0, 6, 0}, {0, 4, 2}, {0, 4, 6},  // 21
    {2, 2, 0}, {4, 2, 0}, {6, 2, 0}, {2, 4, 0}, {6, 4, 0}, {2, 6, 0}, {4, 6, 0},  // 28
    {6, 6, 0}, {2, 4, 2}, {2, 0, 6}, {0, 0, 0}, {0, 7, 0}, {2, 7, 0},             // 35
}};

Mounting angles_at(std::size_t number) {
  const auto [roll, pitch, yaw] = by_number.at(number);
  return {45.0 * roll, 45.0 * pitch, 45.0 * yaw};
}

}  // namespace

NumberedRotation nearest_rotation(const Eigen::Matrix3d& R) {
  constexpr double in_degrees = 180.0 / std::numbers::pi;
  constexpr double rounding = 1e-6;  // deg, by which two that are the same may differ
  NumberedRotation nearest{.apart = 360.0};
  for (std::size_t number = 0; number < by_number.size(); ++number) {
    if (number == no_multiple_of_45) continue;
    const Mounting angles = angles_at(number);
    const Eigen::Matrix3d between = probes::turn_by(angles).transpose() * R;
    const double apart = Eigen::AngleAxisd(between).angle() * in_degrees;
    if (apart >= nearest.apart - rounding) continue;
    nearest = {.number = static_cast<int>(number), .angles = angles, .apart = apart};
  }
  return nearest;
}

std::optional<int> number_of(const Mounting& mounting) {
  constexpr double as_good_as_equal = 1e-3;  // deg
  const NumberedRotation nearest = nearest_rotation(probes::turn_by(mounting));
  if (nearest.apart > as_good_as_equal) return std::nullopt;
  return nearest.number;
}

std::string name_of(const NumberedRotation& rotation) {
  constexpr std::array names{"roll", "pitch", "yaw"};
  std::string name;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (rotation.angles[i] == 0.0) continue;
    name += fmt::format("{}{} {:.0f}", name.empty() ? "" : ", ", names[i], rotation.angles[i]);
  }
  return name.empty() ? "no turn" : name + " deg";
}

}  // namespace sepcal::exporting
