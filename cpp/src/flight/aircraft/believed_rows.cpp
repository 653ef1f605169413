// SPDX-License-Identifier: BSD-3-Clause
#include "flight/aircraft/believed_rows.hpp"

#include <iterator>

#include "flight/aircraft/aircraft_columns.hpp"
#include "flight/aircraft/laid_aircraft.hpp"
#include "flight/checks/suspect_notes.hpp"
#include "flight/checks/taken_rows.hpp"
#include "flight/probes/joined_quantities.hpp"
#include "flight/verbs/mended_flight.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "sepcal/error.hpp"

namespace sepcal::aircraft_log {

BelievedFlight believe(const Flight& flight, AircraftModel model, const LogChoice& choice) {
  verbs::MendedFlight mended = verbs::mend(quantities_of(model), flight, choice);
  BelievedFlight believed{std::move(mended.flight), {}, std::move(mended.filled)};
  const checks::TakenRows taken = checks::take_rows(quantities_of(model), flight, choice);
  const checks::Log log(quantities_of(model), taken.flight);
  std::vector<LogNote> found;
  checks::check_constants(log, found);
  const std::vector<checks::SuspectColumn> suspects = checks::find_suspects(log);
  checks::check_suspects(log, suspects, choice, found);
  for (const checks::SuspectColumn& column : suspects) {
    if (column.role != checks::Role::measured || !checks::leaves_codes_out(log)) continue;
    believed.left_out = checks::join(believed.left_out, column.rows.sentinels);
  }
  for (const LogNote& note : found) {
    if (note.concern != Concern::slight)
      believed.notes.push_back(checks::in_one_line(note, flight.name()));
  }
  return believed;
}

AircraftFit without_suspects(const AircraftFit& fitted, const Flight& flight,
                             std::vector<std::string>& notes) {
  AircraftOptions options = options_on(fitted, flight);
  LogChoice& log = options.calibration.log;
  const ReadFlight read = probes::read_for(quantities_of(options.model), flight, log);
  const verbs::MendedFlight mended = verbs::mend(quantities_of(options.model), read.flight, log);
  if (mended.all.condition.empty()) return fitted;
  log.where = checks::join_conditions(log.where, {mended.all.condition});
  AircraftFit left = fitted;
  left.options.calibration.log.where = log.where;
  if (is_same_flight(fitted, flight)) {
    for (const std::string& name : fitted.initial_states) {  // segments end elsewhere
      options.calibration.fit.start.erase(name);
      options.calibration.fit.fix.erase(name);
    }
    try {
      left = fit_aircraft(flight, options);
    } catch (const Error&) {
      return fitted;  // what is left is no flight
    }
    left.history = fitted.history;
    left.file = fitted.file;
  }
  notes.push_back(verbs::say_left_out(flight.name(), log, mended.all, {}));
  return left;
}

}  // namespace sepcal::aircraft_log
