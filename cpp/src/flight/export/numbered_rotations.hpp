// SPDX-License-Identifier: BSD-3-Clause
// The mountings that PX4 (CAL_MAGn_ROT) and ArduPilot (COMPASS_ORIENT) number alike, as MAVLink's
// MAV_SENSOR_ORIENTATION has them: m_body = R m_sensor, R = Rz(yaw) Ry(pitch) Rx(roll).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "sepcal/detail/flight/probe_columns.hpp"

namespace sepcal::exporting {

inline constexpr int custom_rotation = 100;  // of PX4: by angles of its own

struct NumberedRotation {
  int number = 0;
  Mounting angles{};   // roll, pitch, yaw [deg], multiples of 45
  double apart = 0.0;  // [deg] about one axis, from the rotation that was asked for
};

/// The nearest to R, a rotation; of two that are the same the lower number.
NumberedRotation nearest_rotation(const Eigen::Matrix3d& R);

/// Its number where a mounting is one of them, to a thousandth of a degree.
std::optional<int> number_of(const Mounting& mounting);

/// "roll 180, yaw 45 deg"; "no turn".
std::string name_of(const NumberedRotation& rotation);

}  // namespace sepcal::exporting
