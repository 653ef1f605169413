// SPDX-License-Identifier: BSD-3-Clause
// A vehicle that turns a magnetometer about: through the whole sphere, a little about level, or so
// that the field's direction in body axes keeps to one third of the sphere. Known at any time.
#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "simulation/hidden_driver.hpp"
#include "simulation/simulated_flight.hpp"

namespace sepcal::simulation {

struct VehicleState {
  Eigen::Matrix3d body_to_ned;
  Eigen::Vector3d angles;  // roll, pitch, yaw, each within +-pi [rad]
  Eigen::Vector3d rates;   // p, q, r [rad/s]
  double temperature;      // of the sensor [degC]
  double current;          // from the battery [A]
  double throttle;         // 0 to 1
  double voltage;          // of the battery: falls with time, sags with the current [V]
  double panel_current;    // from solar panels [A]
};

class TurningVehicle {
 public:
  /// `field`: the Earth's, north, east, down, of any length: `third` turns about it. Throws Error
  /// for a field of zeros then, and for a rate or a number of rows out of range.
  TurningVehicle(const SimulationOptions& options, const Eigen::Vector3d& field);

  VehicleState at(double time) const;

  std::string_view label(double time) const;

  const std::vector<double>& times() const { return times_; }  // of the rows [s]

  /// "time", "p", "q", "r", "temp_degc", "current_a", "throttle", "voltage_v", "panel_current_a":
  /// what can drive an effect. The object must outlive the sources.
  Sources sources() const;
  static Moment moment(double time, const VehicleState& state);

 private:
  Excitation excitation_;
  double duration_;               // [s]
  Eigen::Matrix3d field_to_ned_;  // turns down into the field's direction
  std::vector<double> times_;
};

}  // namespace sepcal::simulation
