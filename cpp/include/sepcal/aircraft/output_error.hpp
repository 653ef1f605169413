// SPDX-License-Identifier: BSD-3-Clause
// Output error: aerodynamic parameters with which the aircraft, integrated from its initial state,
// gives the readings. Starts from equation error, as the field has it.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/aircraft/aero_model.hpp"
#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/states/trajectory_options.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// Which states are integrated; the others are read from the record. longitudinal: u w q theta.
/// lateral: v p r phi. six_dof: these and, where yaw is an output, psi.
enum class AircraftAxes { longitudinal, lateral, six_dof };

/// "longitudinal", "lateral", "six-dof".
std::string_view to_string(AircraftAxes axes);

/// The axes of that name. Throws Error listing the names.
AircraftAxes find_aircraft_axes(std::string_view name);

struct OutputErrorOptions {
  AircraftAxes axes = AircraftAxes::six_dof;
  /// Empty: the standard ones of the axes: CX CZ Cm, CY Cl Cn, or all six.
  std::vector<AeroEquation> equations = {};
  /// `measured` and `outputs`, where empty, are the axes' own. Outputs: of airspeed beta alpha roll
  /// pitch ax ay az p q r those that belong to the axes and are columns. Others: yaw vn ve vd.
  TrajectoryOptions trajectory = {};
  /// Of scales and biases of airspeed, flow angles and attitude, those that are estimated; the
  /// others are held at zero. Biases of the inertial unit and the wind are free: `fit.fix` holds
  /// them.
  std::vector<std::string> free = {};
  double gravity = 9.80665;  // m/s^2, at the place of the flight
  double window = 0.0;       // of CoefficientOptions, for the start
  /// `start`, where it names an aerodynamic parameter or an initial state, goes before the one that
  /// is found.
  FitOptions fit = {};
};

/// An aircraft laid along a record, ready for fit(), fit_many(), intervals.
struct AircraftTrajectory {
  std::shared_ptr<const BlockModel> model;
  Record record;  // with a column for each measured state
  FitOptions fit;
  std::vector<AeroEquation> equations;
  std::vector<std::string> notes;
  std::vector<std::string> initial_states;  // names of parameters
  std::string warning;
};

/// Columns as aero_coefficients() takes them, and roll, pitch. Throws Error as it does, for more
/// than 40 regressors or 8 columns among them, and as TrajectoryModel does.
AircraftTrajectory lay_aircraft(const Record& record, const AircraftGeometry& geometry,
                                const OutputErrorOptions& options = {});

/// What output error must say of its intervals where states are read from the record.
inline constexpr std::string_view measured_warning =
    "errors of the states that were read and not integrated are not in these intervals; "
    "six degrees of freedom have them";

/// Fits it. Its warning is measured_warning, or empty where all states but psi are integrated.
AeroFit fit_output_error(const Record& record, const AircraftGeometry& geometry,
                         const OutputErrorOptions& options = {});

/// The record with columns of the states u v w phi theta psi, where it lacks them: from airspeed,
/// alpha, beta, roll, pitch and yaw as logged; psi is zero where there is no yaw, on which nothing
/// depends. What is to be a measured state comes from here.
Record with_states(const Record& record);

}  // namespace sepcal
