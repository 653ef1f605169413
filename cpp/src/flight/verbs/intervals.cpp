// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/intervals.hpp"

#include "base/parts_of_record.hpp"
#include "flight/verbs/at_bound.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "sepcal/composition.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

FlightIntervals find_intervals(const Calibration& given, const Flight& flight,
                               const ProfileOptions& asked) {
  check_fitted(given, flight);
  PreparedFlight prepared = prepare(given, flight);
  const Calibration calibration = along(given, prepared);
  const EffectiveFlight effective = with_effects_of(calibration, prepared);
  const Record& record = effective.prepared.record;
  FitOptions options = calibration.probe->complete(calibration.options.fit, record);
  options.unsampled = initial_corrections(effective.effects);
  return {
      .model = std::string(calibration.probe->name()),
      .flight = FittedFlight{flight.name(), flight.sha256(), flight.rows(), calibration.fit.rows},
      .status = calibration.fit.status,
      .message = calibration.fit.message,
      .at_bound = names_at_bound(calibration.fit),
      .level = asked.level,
      .parameters = profile_intervals(*effective.model, record, calibration.fit, options, asked),
      .notes = effective.prepared.notes};
}

FlightPrediction predict(const Calibration& given, const Flight& flight, double level) {
  if (!given.probe->initial_states().empty()) check_fitted(given, flight);
  PreparedFlight prepared = prepare(given, flight);
  const Calibration calibration = along(given, prepared);
  const EffectiveFlight effective = with_effects_of(calibration, prepared);
  const Record& record = effective.prepared.record;
  return {base::gather_time(record),
          predict(*effective.model, record, calibration.fit, calibration.options.fit, level)};
}

}  // namespace sepcal
