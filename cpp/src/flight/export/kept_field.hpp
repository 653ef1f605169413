// SPDX-License-Identifier: BSD-3-Clause
// A magnetometer in a known field as autopilots hold it. C^-1 = Q S, Q a rotation: S is kept, or a
// symmetric C is fitted anew, in the axes into which the vehicle turns the sensor's readings.
#pragma once

#include <optional>

#include "flight/export/held.hpp"
#include "flight/export/numbered_rotations.hpp"

namespace sepcal::exporting {

/// How the vehicle is to turn a sensor's readings.
struct VehicleMounting {
  Mounting angles{};               // roll, pitch, yaw [deg]
  std::optional<int> number = {};  // as both autopilots count; none: no such mounting is near
  double apart = 0.0;              // [deg] of the mounting that was found, from that number
  double standard_error = 0.0;     // [deg] of the same about its worst axis
  bool found = false;              // by the fit: it may differ from what the calibration has
};

/// That which is asked for, or that of the calibration: a numbered one that is the same or nearly
/// so, else what the calibration finds, its misalignment included. None: the readings are not
/// turned, as far as anyone said.
std::optional<VehicleMounting> vehicle_mounting(const Calibration& calibration,
                                                const ExportOptions& options);

/// The calibration less its rotation: a symmetric C by the polar factor S, where `mounting` turns
/// the readings instead of the calibration's own. What was held by name holds at its value there.
Calibration keep_held(const Calibration& calibration,
                      const std::optional<VehicleMounting>& mounting);

/// The symmetric C that fits a flight best, from what keep_held() gave.
Calibration refit_kept(const Calibration& kept, const Flight& flight, const FitProgress& progress);

/// [deg] about one axis.
double angle_of(const Eigen::Matrix3d& rotation);

/// The rotation from the axes of `held`, as these two gave it, into those of the calibration.
Eigen::Matrix3d lost_rotation(const Calibration& calibration, const Calibration& held);

}  // namespace sepcal::exporting
