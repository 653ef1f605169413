// SPDX-License-Identifier: BSD-3-Clause
// How a three-axis sensor is turned against the vehicle: m_body = R m_sensor, R the 3-2-1 sequence
// of roll, pitch and yaw, as autopilots have it. Found from readings m of a known field h by the
// linear fit m = A h + n, whose polar decomposition A = R' S leaves a symmetric S to the sensor.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/record.hpp"

namespace sepcal::probes {

using Angles = std::array<double, 3>;  // roll, pitch, yaw [deg]

/// R (3 x 3), from the sensor's axes to the body's.
Eigen::Matrix3d turn_by(const Angles& angles);

/// Of the rotation of a quaternion w, x, y, z from the sensor's axes to the body's, which is
/// normalised. Throws Error where its length is off one by more than a hundredth.
Angles angles_of_quaternion(const std::array<double, 4>& quaternion);

/// Of a rotation, roll and yaw within +-180, pitch within +-90 deg.
Angles angles_of(const Eigen::Matrix3d& R);

/// "0,0,30", as a person types them.
std::string name_angles(const Angles& angles);

struct FoundMounting {
  Angles angles{};        // to a tenth of a degree
  double turn = 0.0;      // [deg] about one axis
  double rmse = 0.0;      // [uT] that the linear fit leaves, over all readings
  bool mirrored = false;  // no rotation brings the readings onto the field: an axis points back
};

/// Of the record's rows of mx, my, mz against hx, hy, hz. Where the field turns about one axis
/// alone, A is taken for a rotation and a scale. Nothing where the field hardly turns.
std::optional<FoundMounting> find_mounting(const Record& record);

}  // namespace sepcal::probes
