// SPDX-License-Identifier: BSD-3-Clause
// A small fixed-wing aircraft that flies the input design of Sun & Gebre-Egziabher, Table 5, or
// straight ahead. Airspeed, flow angles, bank, climb and track are chosen; attitude and body rates
// follow from them, and the wind carries the aircraft over the ground. Known at any time.
#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "simulation/hidden_driver.hpp"
#include "simulation/simulated_flight.hpp"

namespace sepcal::simulation {

struct FlightPlan;

struct AircraftState {
  Attitude attitude;
  Eigen::Vector3d rates;     // p, q, r [rad/s]
  Eigen::Vector3d velocity;  // through the air, body axes [m/s]
  Eigen::Vector3d ground;    // over the ground, north, east, down, in the steady wind [m/s]
  double altitude;           // geopotential [m]
  Air air;
  double throttle;  // 0 to 1
  double current;   // [A]
  double flap;      // 0, 1, 2
};

class SmallAircraft {
 public:
  /// `wind`: steady, north, east, down [m/s]; `altitude` at the first row [m]. Throws Error for an
  /// excitation that an aircraft can't fly, and for a rate or a number of rows out of range.
  SmallAircraft(const SimulationOptions& options, Eigen::Vector3d wind, double altitude);

  /// Any time up to a minute before the first row and after the last [s].
  AircraftState at(double time) const;

  std::string_view label(double time) const;

  const std::vector<double>& times() const { return times_; }  // of the rows [s]

  /// "time", "p", "q", "r", "temp_k", "altitude_m", "throttle", "current_a", "flap": what can drive
  /// an effect. The object must outlive the sources.
  Sources sources() const;
  static Moment moment(double time, const AircraftState& state);

 private:
  double altitude_at(double time) const;

  const FlightPlan& plan_;
  Eigen::Vector3d wind_;
  std::vector<double> times_;
  std::vector<double> altitudes_;  // at evenly spaced nodes [m]
  std::vector<double> climbs_;     // their rates [m/s]
};

}  // namespace sepcal::simulation
