// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/track.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/name_list.hpp"
#include "flight/tracks/flight_rows.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/flight/joint.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace verbs;  // the room below

namespace {

/// Each parameter as the calibration has it, but for those of the flight alone.
std::map<std::string, Normal> priors_of(const Fit& fit, const std::vector<std::string>& own) {
  std::vector<std::string> names;
  std::map<std::string, Normal> priors;
  for (const Parameter& parameter : fit.parameters) {
    if (!(parameter.standard_error > 0.0)) continue;  // held
    names.push_back(parameter.name);
    if (std::ranges::find(own, parameter.name) != own.end()) continue;
    priors[parameter.name] = {parameter.value, parameter.standard_error};
  }
  for (const std::string& name : own) {
    if (std::ranges::find(names, name) != names.end()) continue;
    throw OptionError({Option{"own"}, fmt::format(": '{}' is not estimated; there are {}", name,
                                                  base::list_first(names, 12))});
  }
  return priors;
}

StreamStart start_of(const Calibration& calibration, const Flight& flight,
                     const EffectiveFlight& effective, const FlightTrackOptions& options) {
  if (!flight.sha256().empty() && flight.sha256() == calibration.flight.sha256 &&
      (options.start_rows == 0 || !options.own.empty())) {
    throw OptionError(
        {"the calibration is of this flight, whose rows must not count twice; start "
         "from its first ones alone, by ",
         Option{"start_rows"}});
  }
  if (options.start_rows == 0) {
    if (options.own.empty()) return start_from_fit(calibration.fit);
    throw OptionError({Option{"own"}, " is found in the first rows: give their number too, by ",
                       Option{"start_rows"}});
  }
  FitOptions fit =
      calibration.probe->complete(options_from(calibration, {}, {}).fit, effective.prepared.record);
  fit.unsampled = initial_corrections(effective.effects);
  fit.noise = options.how.noise;
  fit.stage_one_segments.clear();  // of the calibration's own flight
  fit.stage_two_segments.clear();
  if (!options.own.empty()) fit.prior = priors_of(calibration.fit, options.own);
  return start_from_rows(*effective.model, effective.prepared.record, options.start_rows, fit);
}

}  // namespace

TrackedFlight track(const Calibration& calibration, const Flight& flight,
                    const FlightTrackOptions& options) {
  if (!calibration.probe->initial_states().empty()) {
    throw Error("a model with a state is followed by sepcal.track(model, columns), not by this");
  }
  if (joint_setup(*calibration.probe) != nullptr) {
    throw Error("the calibration is of several flights; track one of its own");
  }
  const PreparedFlight prepared = prepare(calibration, flight);
  const EffectiveFlight effective = with_effects_of(calibration, prepared);
  const Record& record = effective.prepared.record;
  TrackedFlight tracked{.track = {},
                        .table = {},
                        .outputs = effective.model->tables().outputs,
                        .file = flight.name(),
                        .notes = effective.prepared.notes};
  if (options.start_rows == 0) {
    tracked.notes.emplace_back(
        "every parameter begins as the calibration has it, the wind of its flight too; find what "
        "is "
        "this flight's own in its first rows: --start-rows N --own w_n,w_e");
  }
  const StreamStart start = start_of(calibration, flight, effective, options);
  tracked.track = sepcal::track(*effective.model, record, start, options.how);
  const std::vector<Variable> known = effective.model->tables().parameters();
  for (const std::string& name : tracked.track.names) {
    tracked.table.push_back(*std::ranges::find(known, name, &Variable::name));
  }
  tracks::set_flight_rows(tracked, prepared.readings.flight_rows);
  return tracked;
}

}  // namespace sepcal
