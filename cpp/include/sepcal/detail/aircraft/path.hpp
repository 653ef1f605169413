// SPDX-License-Identifier: BSD-3-Clause
// A flight path laid along a record, with what is measured, held and started from.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/models/flight_path.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

struct PathOptions {
  /// Outputs, where empty: those of airspeed beta alpha roll pitch yaw vn ve vd that are columns,
  /// with `position` of north east down too. psi joins `measured` where there is neither yaw nor a
  /// velocity or position over the ground.
  TrajectoryOptions trajectory = {};
  bool position = false;                           // x y z are states
  double gravity = 9.80665;                        // m/s^2, at the place of the flight
  Eigen::Vector3d vane = Eigen::Vector3d::Zero();  // from the inertial unit, body axes, m
  /// FlightPath::held_at_zero is held unless named here or by fit.fix.
  std::vector<std::string> free = {};
  /// `start` of initial states goes before the first readings.
  FitOptions fit = {};
};

/// Ready for fit(), fit_many(), intervals.
struct PathTrajectory {
  std::shared_ptr<const StateBlockModel> model;  // FlightPath, or FlightPathWithPosition
  Record record;                                 // with a column for each measured state
  FitOptions fit;
  std::vector<std::string> initial_states;  // names of parameters
};

/// The white noise of an inertial unit as its readings tell it, for FitOptions::process_noise: by
/// name of FlightPath::noise, from fourth differences of each column. Vibration counts as noise,
/// and drift is not seen. Columns without any (held, simulated without noise) are left out.
std::map<std::string, double> noise_of_readings(const Record& record);

/// The standard deviation of white noise on each column, by fourth differences: what is smooth, as
/// motion and drift are, has none.
std::map<std::string, double> white_noise_of(const Record& record,
                                             const std::vector<std::string>& columns);

/// Throws Error for a record without any of the outputs, a parameter to free that isn't held, and
/// as TrajectoryModel does.
PathTrajectory lay_path(const Record& record, const PathOptions& options = {});

}  // namespace sepcal
