// SPDX-License-Identifier: BSD-3-Clause
// The two-step method, S 6.3: first the flight path with the sensors' errors, then, where the state
// is known, the aerodynamics by least squares.
#pragma once

#include <string>
#include <vector>

#include "sepcal/aircraft/aero_model.hpp"
#include "sepcal/detail/states/trajectory_options.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

struct TwoStepOptions {
  /// Empty: the standard ones of all six coefficients.
  std::vector<AeroEquation> equations = {};
  /// Of the path. Outputs, where empty: those of airspeed beta alpha roll pitch yaw vn ve vd that
  /// are columns. `measured` as it stands; psi is added where there is neither yaw nor a velocity
  /// over the ground.
  TrajectoryOptions path = {};
  double gravity = 9.80665;  // m/s^2, at the place of the flight
  double window = 0.0;       // of CoefficientOptions
  /// `start` of initial states goes before the first readings; FlightPath::held_at_zero is held
  /// unless `fixed` or `free` names it.
  FitOptions path_fit = {};
  std::vector<std::string> free = {};
  FitOptions aero_fit = {};
};

struct TwoStep {
  Fit path;
  std::vector<std::string> initial_states;  // names of the path's parameters
  Record reconstructed;                     // see reconstruct()
  AeroFit aero;                             // whose warning stands for both steps
};

/// Columns as FlightPath and aero_coefficients() take them. Throws Error as they do.
TwoStep two_step(const Record& record, const AircraftGeometry& geometry,
                 const TwoStepOptions& options = {});

}  // namespace sepcal
