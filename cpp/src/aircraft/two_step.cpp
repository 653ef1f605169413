// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/aircraft/two_step.hpp"

#include <algorithm>

#include "base/short_number.hpp"
#include "sepcal/detail/aircraft/path.hpp"
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

}  // namespace

TwoStep two_step(const Record& record, const AircraftGeometry& geometry,
                 const TwoStepOptions& options) {
  check_geometry(geometry);
  std::vector<std::string> coefficients;
  for (const AeroEquation& equation : options.equations) {
    coefficients.push_back(equation.coefficient);
  }
  const CoefficientOptions wanted{.coefficients = coefficients, .window = options.window};
  aero_coefficients(record, geometry, wanted);  // what is missing is said before the path is fitted
  PathTrajectory path = lay_path(record, {.trajectory = options.path,
                                          .gravity = options.gravity,
                                          .vane = geometry.vane - geometry.imu,
                                          .free = options.free,
                                          .fit = options.path_fit});
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

}  // namespace sepcal
