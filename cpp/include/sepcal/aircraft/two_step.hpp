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
#include "sepcal/states/track.hpp"

namespace sepcal {

struct TwoStepOptions {
  /// Empty: the standard ones of all six coefficients.
  std::vector<AeroEquation> equations = {};
  /// Of the path. Outputs, where empty: those of airspeed beta alpha roll pitch yaw vn ve vd that
  /// are columns. `measured` as it stands; psi is added where there is neither yaw nor a velocity
  /// over the ground.
  TrajectoryOptions path = {};
  bool position = false;     // of PathOptions
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

/// Where both steps begin in flight: start_from_fit() of another flight's, or of first rows.
struct TwoStepStart {
  StreamStart path;
  StreamStart aero;
};

/// The two steps on a record's first rows. Throws Error as two_step() does, and for too few rows.
TwoStepStart start_two_steps(const Record& record, const AircraftGeometry& geometry,
                             std::size_t rows, const TwoStepOptions& options = {});

struct TwoStepTrack {
  Track path;
  Track aero;                     // its rows are the path's
  std::vector<Variable> table;    // of path.names, then aero.names, with units
  std::vector<Variable> outputs;  // of the path's innovations, then the coefficients'
};

/// Both steps in flight: a filter of the path, and least squares of the coefficients where it says
/// the aircraft is. `path` and `aero` say how each is followed; a path without process noise takes
/// that of its readings. Rates are differentiated over `window`, so that the coefficients of a row
/// are known half a window later, unless the record has pdot qdot rdot. Throws Error as two_step()
/// and track() do.
TwoStepTrack track_two_steps(const Record& record, const AircraftGeometry& geometry,
                             const TwoStepStart& start, const TwoStepOptions& options = {},
                             TrackOptions path = {},
                             const TrackOptions& aero = {.method = TrackMethod::rls});

}  // namespace sepcal
