// SPDX-License-Identifier: BSD-3-Clause
// Which regressor a fitted aircraft lacks.
#include <fmt/format.h>

#include "flight/aircraft/aircraft_effects.hpp"
#include "flight/aircraft/coefficient_diagnosis.hpp"
#include "flight/aircraft/laid_aircraft.hpp"
#include "flight/verbs/misfits.hpp"
#include "flight/verbs/stepwise_loop.hpp"
#include "sepcal/flight/aircraft.hpp"

namespace sepcal {

using namespace aircraft_log;  // this room's own

namespace {

/// Throws Error for models whose effects are not known yet.
void check_diagnosable(const AircraftFit& fitted) {
  if (fitted.options.model == AircraftModel::aero) return;
  throw Error(
      fmt::format("diagnose knows no effects of the model '{}'; compare says where it fails, and "
                  "--model aero which regressors the coefficients lack",
                  to_string(fitted.options.model)));
}

}  // namespace

FlightDiagnosis diagnose_aircraft(const AircraftFit& fitted, const Flight& flight,
                                  const DiagnosisOptions& options) {
  check_diagnosable(fitted);
  LaidAircraft laid = lay(flight, options_on(fitted, flight));
  return within(flight, [&] {
    FlightDiagnosis result;
    result.model = to_string(fitted.options.model);
    result.app = "sepcal-aircraft";
    result.calibration = fitted.file;
    result.status = fitted.fit.status;
    result.message = fitted.fit.message;
    result.diagnosis = diagnose_coefficients(fitted, flight, laid, options);
    result.notes = std::move(laid.notes);
    if (!is_same_flight(fitted, flight)) {
      result.notes.push_back(
          fmt::format("{} is not the flight of the fit: the errors here are those of a prediction",
                      flight.name()));
    }
    for (const EffectFinding& effect : result.diagnosis.effects) {
      result.sentences.push_back(describe_regressor(effect.name));
    }
    const DiagnosedFit whole = diagnosed_coefficients(fitted, laid);
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
  Stepwise course = verbs::run_stepwise<AircraftFit>(
      now, options.most,
      [&](const AircraftFit& at) { return diagnose_aircraft(at, flight, options.diagnosis); },
      [&](const AircraftFit& at, const std::string& effect) {
        return add_to_aircraft(at, flight, effect);
      });
  return {std::move(now), std::move(course)};
}

}  // namespace sepcal
