// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/aircraft/two_step.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "base/short_number.hpp"
#include "sepcal/detail/aircraft/path.hpp"
#include "sepcal/error.hpp"
#include "sepcal/states/reconstruct.hpp"

namespace sepcal {
namespace {

/// The dynamic pressure goes with the airspeed squared, and so does every coefficient.
void note_airspeed(const Fit& path, AeroFit& aero) {
  const auto scale = std::ranges::find(path.parameters, "lambda_v", &Parameter::name);
  if (scale == path.parameters.end() || scale->fixed) return;
  const double moved = 200.0 * scale->standard_error / (1.0 + scale->value);
  aero.notes.push_back(
      "the airspeed was corrected by lambda_v, whose standard error moves every "
      "coefficient by " +
      base::short_number(moved) +
      " %; hold it at a calibration's where that is "
      "better");
}

CoefficientOptions wanted_of(const TwoStepOptions& options) {
  CoefficientOptions wanted{.coefficients = {}, .window = options.window};
  for (const AeroEquation& equation : options.equations) {
    wanted.coefficients.push_back(equation.coefficient);
  }
  return wanted;
}

PathTrajectory path_of(const Record& record, const AircraftGeometry& geometry,
                       const TwoStepOptions& options) {
  return lay_path(record, {.trajectory = options.path,
                           .position = options.position,
                           .gravity = options.gravity,
                           .vane = geometry.vane - geometry.imu,
                           .free = options.free,
                           .fit = options.path_fit});
}

}  // namespace

TwoStep two_step(const Record& record, const AircraftGeometry& geometry,
                 const TwoStepOptions& options) {
  check_geometry(geometry);
  const CoefficientOptions wanted = wanted_of(options);
  aero_coefficients(record, geometry, wanted);  // what is missing is said before the path is fitted
  PathTrajectory path = path_of(record, geometry, options);
  if (path.fit.process_noise.empty()) path.fit.process_noise = noise_of_readings(path.record);
  TwoStep found;
  found.path = fit(*path.model, path.record, path.fit);
  found.initial_states = path.initial_states;
  found.reconstructed = reconstruct(*path.model, found.path.by_name(), path.record);
  found.aero = fit_equation_error(aero_coefficients(found.reconstructed, geometry, wanted),
                                  options.equations, options.aero_fit);
  note_airspeed(found.path, found.aero);
  return found;
}

TwoStepStart start_two_steps(const Record& record, const AircraftGeometry& geometry,
                             std::size_t rows, const TwoStepOptions& asked) {
  if (rows == 0 || rows >= record.rows()) {
    throw Error("start_rows is " + std::to_string(rows) + "; the record has " +
                std::to_string(record.rows()) +
                " rows: take fewer, so that some are left to track");
  }
  TwoStepOptions options = asked;
  std::map<std::string, double>& noise = options.path_fit.process_noise;
  if (noise.empty()) noise = noise_of_readings(record);
  const TwoStep found = two_step(first_rows(record, rows), geometry, options);
  for (const Fit& step : {found.path, found.aero.fit}) {
    if (step.status == FitStatus::converged) continue;
    throw Error("the first " + std::to_string(rows) +
                " rows don't tell both steps: take more of them, or hold parameters (" +
                step.message + ")");
  }
  StreamStart path = start_from_fit(found.path);  // its covariance allows for that noise
  path.rows = rows;
  path.process_noise = Eigen::VectorXd::Zero(FlightPath::noise.size());
  for (std::size_t i = 0; i < FlightPath::noise.size(); ++i) {
    const auto density = noise.find(std::string(FlightPath::noise[i].name));
    if (density != noise.end()) path.process_noise[static_cast<Eigen::Index>(i)] = density->second;
  }
  return {std::move(path), start_from_fit(found.aero.fit)};
}

TwoStepTrack track_two_steps(const Record& record, const AircraftGeometry& geometry,
                             const TwoStepStart& start, const TwoStepOptions& options,
                             TrackOptions path, const TrackOptions& aero) {
  check_geometry(geometry);
  const PathTrajectory laid = path_of(record, geometry, options);
  if (path.process_noise.empty()) path.process_noise = noise_of_readings(laid.record);
  TwoStepTrack tracked{.path = track(*laid.model, laid.record, start.path, path),
                       .aero = {},
                       .table = {},
                       .outputs = laid.model->tables().outputs};
  const AeroCoefficients coefficients = aero_coefficients(
      reconstruct(*laid.model, tracked.path, laid.record), geometry, wanted_of(options));
  const std::vector<AeroEquation> equations =
      options.equations.empty() ? standard_equations(coefficients.names) : options.equations;
  const AeroModel model(equations);
  tracked.aero = track(model, coefficients.record, start.aero, aero);
  tracked.table = table_of(tracked.path, *laid.model);
  const std::vector<Variable> table = table_of(tracked.aero, model);
  tracked.table.insert(tracked.table.end(), table.begin(), table.end());
  const std::vector<Variable>& outputs = model.tables().outputs;
  tracked.outputs.insert(tracked.outputs.end(), outputs.begin(), outputs.end());
  return tracked;
}

}  // namespace sepcal
