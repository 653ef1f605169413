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
#include "flight/files/flight_digest.hpp"
#include "flight/verbs/injection.hpp"
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

/// Of a fit that is laid along the flight. `notes` come before those of the log.
FlightDiagnosis diagnose_laid(const AircraftFit& fitted, const Flight& flight, LaidAircraft& laid,
                              std::vector<std::string> notes, const DiagnosisOptions& options) {
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
  result.notes = std::move(notes);
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
}

/// What an effect adds to the outputs along the flight, where the model without it is at
/// `estimates`.
Eigen::MatrixXd added_outputs(const AircraftFit& fitted, const Flight& flight,
                              const base::ParameterValues& estimates, const SizedEffect& injected,
                              Injection& injection) {
  AircraftOptions options = options_on(fitted, flight);
  options.calibration.effects.push_back({.name = injected.name});
  LaidAircraft with = aircraft_log::lay(flight, options);
  need_every_reading(with, "diagnose");
  verbs::check_new(with.effects);
  injection.effect = with.effects.back().name;
  const bool is_along = acts_along(fitted.options.model, injection.effect);
  base::ThreadPool pool(fitted.options.calibration.fit.threads);
  return verbs::added_outputs(
      {*with.model, with.record, estimates, is_along ? verbs::shape_of(with.along.back()) : ""},
      injected, injection, pool);
}

}  // namespace

FlightDiagnosis diagnose_aircraft(const AircraftFit& base, const Flight& flight,
                                  const DiagnosisOptions& options) {
  need_rows_in_time(base, "has no rows for a diagnosis to test");
  std::vector<std::string> left_out;
  const AircraftFit fitted = without_suspects(base, flight, left_out);
  LaidAircraft laid = lay(flight, options_on(fitted, flight));
  need_every_reading(laid, "diagnose");
  return within(flight,
                [&] { return diagnose_laid(fitted, flight, laid, std::move(left_out), options); });
}

FlightDiagnosis diagnose_aircraft_with(const SizedEffect& injected, const AircraftFit& base,
                                       const Flight& flight, const DiagnosisOptions& options) {
  need_rows_in_time(base, "has no rows for a diagnosis to test");
  std::vector<std::string> left_out;
  AircraftFit fitted = without_suspects(base, flight, left_out);
  Injection injection;
  LaidAircraft laid = aircraft_log::lay(flight, options_on(fitted, flight));
  need_every_reading(laid, "diagnose");
  return within(flight, [&] {
    const Fit at = fit_on(flight, fitted, laid);
    const Eigen::MatrixXd added = added_outputs(fitted, flight, at.by_name(), injected, injection);
    const Record original = laid.record;
    laid.record = verbs::with_outputs(original, laid.model->tables().outputs, added);
    FitOptions again = laid.fit;
    for (const auto& [name, value] : at.nonlinear_estimates()) {
      if (!again.fix.contains(name)) again.start[name] = value;
    }
    fitted.fit = fit_laid(laid, again);
    fitted.flight.sha256 = files::digest_of(flight);
    FlightDiagnosis result = diagnose_laid(fitted, flight, laid, std::move(left_out), options);
    verbs::judge_injection(result.diagnosis, injection);
    result.injection = std::move(injection);
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
