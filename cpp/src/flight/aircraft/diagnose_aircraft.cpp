// SPDX-License-Identifier: BSD-3-Clause
// Which effect or regressor a fitted aircraft lacks.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

#include "flight/aircraft/aircraft_effects.hpp"
#include "flight/aircraft/believed_rows.hpp"
#include "flight/aircraft/coefficient_diagnosis.hpp"
#include "flight/aircraft/laid_aircraft.hpp"
#include "flight/aircraft/trajectory_effects.hpp"
#include "flight/verbs/misfits.hpp"
#include "flight/verbs/stepwise_loop.hpp"
#include "sepcal/flight/aircraft.hpp"

namespace sepcal {

using namespace aircraft_log;  // this room's own

namespace {

/// A fit to be diagnosed, what it found, and what its effects are in words.
struct Diagnosed {
  DiagnosedFit fitted;
  Diagnosis found;
  std::function<std::string(const std::string& effect)> describe;
};

/// By equation error, coefficient by coefficient.
Diagnosed diagnose_equations(const AircraftFit& fitted, const Flight& flight, LaidAircraft& laid,
                             const DiagnosisOptions& options) {
  return {diagnosed_coefficients(fitted, laid),
          diagnose_coefficients(fitted, flight, laid, options), describe_regressor};
}

/// By output or filter error, along the trajectory.
Diagnosed diagnose_trajectory(const AircraftFit& fitted, const Flight& flight, LaidAircraft& laid,
                              const DiagnosisOptions& options) {
  const AircraftModel model = fitted.options.model;
  const Fit fit = fit_on(flight, fitted, laid);
  DiagnosedFit along = diagnosed_trajectory(fitted, fit, laid, flight, options.only);
  Diagnosis found = diagnose(
      along, options.only.empty() ? list_along(fitted, laid, flight) : options.only, options);
  if (along.noise && fit.method == FitMethod::output_error) {  // it is the residual that will fall
    along.noise.reset();
    const std::vector<double> drops = predicted_drops(along, found.effects, options.threads);
    for (std::size_t i = 0; i < drops.size(); ++i) found.effects[i].predicted_drop = drops[i];
  }
  return {std::move(along), std::move(found),
          [=](const std::string& effect) { return describe_along(model, effect); }};
}

}  // namespace

FlightDiagnosis diagnose_aircraft(const AircraftFit& base, const Flight& flight,
                                  const DiagnosisOptions& options) {
  std::vector<std::string> left_out;
  const AircraftFit fitted = without_suspects(base, flight, left_out);
  LaidAircraft laid = lay(flight, options_on(fitted, flight));
  return within(flight, [&] {
    FlightDiagnosis result;
    result.model = to_string(fitted.options.model);
    result.app = "sepcal-aircraft";
    result.calibration = fitted.file;
    result.status = fitted.fit.status;
    result.message = fitted.fit.message;
    Diagnosed diagnosed = fitted.options.model == AircraftModel::aero
                              ? diagnose_equations(fitted, flight, laid, options)
                              : diagnose_trajectory(fitted, flight, laid, options);
    result.diagnosis = std::move(diagnosed.found);
    result.notes = std::move(left_out);
    std::ranges::move(laid.notes, std::back_inserter(result.notes));
    if (!is_same_flight(fitted, flight)) {
      result.notes.push_back(
          fmt::format("{} is not the flight of the fit: the errors here are those of a prediction",
                      flight.name()));
    }
    for (const EffectFinding& effect : result.diagnosis.effects) {
      result.sentences.push_back(diagnosed.describe(effect.name));
    }
    const DiagnosedFit& whole = diagnosed.fitted;
    std::size_t used = 0;
    for (const Segment& segment : whole.rows) used += segment.rows();
    result.flight = {flight.name(), flight.sha256(), flight.rows(), used};
    result.where = verbs::measure_parts(whole);
    return result;
  });
}

StepwiseAircraft diagnose_aircraft_stepwise(const AircraftFit& fitted, const Flight& flight,
                                            const StepwiseOptions& options) {
  verbs::check_most(options);
  AircraftFit now =
      is_same_flight(fitted, flight) ? fitted : fit_aircraft(flight, options_on(fitted, flight));
  const verbs::StepwiseLoop<AircraftFit> loop{
      now, options.most,
      [&](const AircraftFit& at, const std::string& only, std::size_t among) {
        return diagnose_aircraft(at, flight, verbs::about(options.diagnosis, only, among));
      },
      [&](const AircraftFit& at, const std::string& effect) {
        return add_to_aircraft(at, flight, effect);
      }};
  Stepwise course = loop.run(now);
  return {std::move(now), std::move(course)};
}

}  // namespace sepcal
