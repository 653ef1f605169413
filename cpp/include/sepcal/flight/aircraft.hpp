// SPDX-License-Identifier: BSD-3-Clause
// Aircraft from flight logs: the flight path with the sensors' errors, aerodynamic coefficients by
// equation error, output error and in two steps; what `sepcal-aircraft` does.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/aircraft/geometry.hpp"
#include "sepcal/detail/aircraft/equations.hpp"
#include "sepcal/detail/flight/output_file.hpp"
#include "sepcal/detail/frequency/transform.hpp"
#include "sepcal/detail/states/trajectory_options.hpp"
#include "sepcal/flight/apply.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/check.hpp"
#include "sepcal/flight/comparison.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"
#include "sepcal/flight/intervals.hpp"
#include "sepcal/flight/stepwise.hpp"
#include "sepcal/flight/track.hpp"
#include "sepcal/states/smooth_record.hpp"

namespace sepcal {

/// path: flight path reconstruction. longitudinal, lateral, six_dof: the aircraft by output error.
/// aero: its coefficients by equation error.
enum class AircraftModel { path, longitudinal, lateral, six_dof, aero };

/// "path", "longitudinal", "lateral", "six-dof", "aero".
std::string_view to_string(AircraftModel model);

/// The model of that name. Throws Error listing the names.
AircraftModel find_aircraft_model(std::string_view name);

struct AircraftOptions {
  AircraftModel model = AircraftModel::path;
  /// Needed by all models but path, which takes of it where the vane is.
  std::optional<AircraftGeometry> geometry = {};
  /// Empty: the model's own, S 6.8 to 6.13. Effects join them: "Cm[alpha^2]".
  std::vector<AeroEquation> equations = {};
  TrajectoryOptions trajectory = {};  // of path, where `outputs` are empty: those that are logged
  /// Of a path: x y z are states too, and north, east, down outputs, logged in metres or made of
  /// lat, lon and altitude; then a velocity that comes from these is no output.
  bool position = false;
  double gravity = 9.80665;  // m/s^2, at the place of the flight
  double window = 0.0;       // of CoefficientOptions, s
  /// Fitted over these frequencies instead of in time: aero by fit_in_band(), an aircraft by
  /// fit_output_error_in_band().
  std::optional<Band> band = {};
  /// Of `free`: what a path holds at zero (FlightPath::held_at_zero), or scales and biases of an
  /// aircraft's outputs. Of `effects` the names alone.
  CalibrationOptions calibration = {};
};

/// An effect that was added, and the error of each output without and with it.
struct AddedRegressor {
  std::string effect;
  std::vector<OutputValue> rmse_before;
  std::vector<OutputValue> rmse_after;
  double predicted_drop = not_a_number;  // of the error over all outputs, each in units of its own,
                                         // as one step promised; NaN of equation error

  /// The same as it fell.
  double drop() const;
};

/// What BASE.json of an aircraft holds.
struct AircraftFit {
  AircraftOptions options;
  FittedFlight flight;
  std::vector<AeroEquation> equations;  // with the effects' terms; of path none
  Fit fit;
  std::vector<std::string> initial_states = {};  // names of these parameters
  std::vector<AddedRegressor> history = {};
  std::vector<std::string> notes = {};  // one line each, for people
  std::string warning = {};             // of the intervals; empty: none
  std::string file = {};                // that it was read from
};

/// "output-error", "filter-error"; of aero "equation-error"; over a band
/// "frequency-output-error", "frequency-equation-error".
std::string_view method_of(const AircraftFit& fitted);

/// "Cm=1,alpha,q_hat". Throws Error, which says how to write it.
AeroEquation parse_equation(std::string_view text);

/// Columns by their headers: time, ax ay az, p q r, and as the model asks airspeed, alpha, beta,
/// roll, pitch, yaw, vn ve vd, elevator, aileron, rudder, throttle, thrust, mass, rho (or temp and
/// ps, or qbar), pdot qdot rdot, each with a unit. Throws Error for what is missing or makes no
/// sense, in one line.
AircraftFit fit_aircraft(const Flight& flight, const AircraftOptions& options);

/// What a log is, column by column, and what that does to a fit of that model (check.hpp).
FlightCheck check_aircraft(AircraftModel model, const Flight& flight, const LogChoice& log = {},
                           const std::function<std::string(const std::string& name)>& spell = {});

/// Several flights fitted together: their segments follow each other, each with initial states of
/// its own, and share all else. In the order in which a fit has them, where `fitted` names them.
/// Throws Error for fewer than two, two of one name, or a flight without a time.
Flight join_aircraft_flights(std::vector<Flight> flights, const LogChoice& log,
                             std::vector<std::string>& notes, const AircraftFit* fitted = nullptr);

/// The path and, where it was reconstructed, the aerodynamics (options.model is not looked at).
struct TwoStepFit {
  AircraftFit path;
  AircraftFit aero;
  std::vector<std::string> notes = {};
};
TwoStepFit fit_two_steps(const Flight& flight, const AircraftOptions& options);

/// The page of a sensor's comparison. Of another flight than the fitted one the initial states are
/// estimated anew, all else held; a note says so. `references` as of compare(); of what
/// apply_aircraft() gives, `_cal` before `_model`.
Comparison compare_aircraft(const AircraftFit& fitted, const Flight& flight,
                            const std::vector<std::string>& references = {});

/// What it lacks: of coefficients the usual regressors, of `aero` splines too, and every other
/// channel of the log; along a trajectory what the sensors and the wind may have. Throws Error for
/// bad input.
FlightDiagnosis diagnose_aircraft(const AircraftFit& base, const Flight& flight,
                                  const DiagnosisOptions& options = {});

/// The same with an effect put into the measurements first, to which it is then fitted anew from
/// its estimates. Throws Error also for an effect that the fit has, and another number of sizes
/// than one or the effect's coefficients.
FlightDiagnosis diagnose_aircraft_with(const SizedEffect& injected, const AircraftFit& base,
                                       const Flight& flight, const DiagnosisOptions& options = {});

/// Profiles the fit on its own flight. Throws Error as profile_intervals() does, for another
/// flight, and for filter error, whose noises would have to be found again at every point.
FlightIntervals find_aircraft_intervals(const AircraftFit& fitted, const Flight& flight,
                                        const ProfileOptions& asked = {});

/// The same fit with an effect more, from where it ended: "Cm[alpha^2]", "Cm[alpha*elevator]"; of
/// `aero` also "CX[spline(alpha,5)]"; along a trajectory those that aircraft_effects_text() lists.
AircraftFit add_to_aircraft(const AircraftFit& base, const Flight& flight,
                            const std::string& effect);

struct StepwiseAircraft {
  AircraftFit fitted;
  Stepwise course;
};

/// By diagnose_aircraft() and add_to_aircraft(), until nothing passes; of another flight than the
/// fitted one the same model is fitted to it first. Throws Error as these do for the fit given, and
/// for `most` 0.
StepwiseAircraft diagnose_aircraft_stepwise(const AircraftFit& fitted, const Flight& flight,
                                            const StepwiseOptions& options = {});

/// Process noise: root of the spectral density by the name and in the unit of the model's table.
using ProcessNoise = std::map<std::string, double>;

/// What was flown, a column each with a value a row of the flight, NaN outside the segments: of
/// every model the outputs as modelled (`alpha_model_rad`); of a path also the inertial unit's
/// readings corrected (`ax_cal_mps2`), the states (`u_mps`), and, where there is a geometry, the
/// coefficients. With process noise, given or that of a fit by filter error, also what the smoother
/// says (smooth_record.hpp): states and noises with their standard deviations (`u_smooth_mps`,
/// `u_sd_mps`, `w_ax_mps2`, `w_ax_sd_mps2`), and the filter's innovations (`alpha_innovation_rad`).
/// What there is to note is added to `notes`.
std::vector<CorrectedColumn> apply_aircraft(const AircraftFit& fitted, const Flight& flight,
                                            const ProcessNoise& process_noise,
                                            std::vector<std::string>& notes);

/// Writes the log with these columns more; `output` appears whole or not at all.
Applied apply_aircraft_to_file(const AircraftFit& fitted, const std::string& file,
                               const std::string& output, const ProcessNoise& process_noise = {},
                               const Progress& progress = {});

/// States and process noise of a flight, given all of it, at the fit's parameters: rows as in the
/// flight. Throws Error as smooth() does, and for equation error, which has no state.
SmoothedRecord smooth_aircraft(const AircraftFit& fitted, const Flight& flight,
                               const ProcessNoise& process_noise);

/// Throws Error as track() and fit_aircraft() do, and where the flight is the calibration's own,
/// whose rows must not count twice.
TrackedFlight track_aircraft(const AircraftFit& fitted, const Flight& flight,
                             const FlightTrackOptions& options = {});

/// The path followed by a filter, and the aerodynamics where it says the aircraft is, row by row:
/// from two steps of another flight, or from `start_rows`. Throws Error as track_aircraft() does.
TrackedFlight track_two_steps(const TwoStepFit& fitted, const Flight& flight,
                              const FlightTrackOptions& options = {});

std::string to_text(const AircraftFit& fitted, Detail detail = Detail::brief);
std::string to_json(const AircraftFit& fitted);
std::string to_text(const StepwiseAircraft& result, Detail detail = Detail::brief);
std::string to_json(const StepwiseAircraft& result);
std::string to_text(const TwoStepFit& fitted, Detail detail = Detail::brief);
std::string to_json(const TwoStepFit& fitted);
std::string to_text(const Applied& applied, const AircraftFit& fitted);
std::string to_json(const Applied& applied, const AircraftFit& fitted);

/// Reads what to_json() wrote. Throws Error for anything else.
AircraftFit parse_aircraft_fit(std::string_view json, const std::string& source);
AircraftFit read_aircraft_fit(const std::string& file);

/// The same of two steps; nothing where the file is no such fit.
std::optional<TwoStepFit> read_two_step_fit(const std::string& file);

/// The regressors that each coefficient has by itself, and how others are written.
std::string aircraft_effects_text();
std::string aircraft_effects_json();

}  // namespace sepcal
