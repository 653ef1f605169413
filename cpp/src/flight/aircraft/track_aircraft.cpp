// SPDX-License-Identifier: BSD-3-Clause
// Estimates of an aircraft against time: a fit's model followed by a recursive estimator.
#include <fmt/format.h>

#include <algorithm>

#include "flight/aircraft/laid_aircraft.hpp"
#include "flight/tracks/tracked_rows.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/aircraft.hpp"

namespace sepcal {

using namespace aircraft_log;  // this room's own

namespace {

StreamStart start_of(const AircraftFit& fitted, const Flight& flight, const LaidAircraft& laid,
                     const FlightTrackOptions& how) {
  const std::size_t rows = how.start_rows;
  if (rows == 0) {
    if (is_same_flight(fitted, flight)) {
      throw Error(
          "the fit is of this flight, whose rows must not count twice; start from its first ones, "
          "by --start-rows N (start_rows=N)");
    }
    return start_from_fit(fitted.fit);
  }
  AircraftOptions options = fitted.options;
  if (how.how.method == TrackMethod::rml || !how.how.process_noise.empty()) {
    options.calibration.fit.method = FitMethod::filter_error;
    if (how.how.method != TrackMethod::rml) {
      options.calibration.fit.process_noise = how.how.process_noise;
    }
  }
  if (!how.how.noise.empty()) options.calibration.fit.noise = how.how.noise;
  if (laid.initial_states.empty()) {
    return start_from_rows(*laid.model, readings_of(laid), rows, options.calibration.fit);
  }
  for (const std::string& name : fitted.initial_states) {  // of other segments than the first rows'
    options.calibration.fit.start.erase(name);
  }
  const LaidAircraft batch = lay_first_rows(flight, options, rows);
  return start_from_rows(*batch.model, readings_of(laid), rows, batch.fit);
}

/// Names with their units: states first, then parameters.
std::vector<Variable> table_of(const Track& track, const BlockModel& model) {
  std::vector<Variable> known = model.tables().parameters();
  if (const auto* along = dynamic_cast<const StateBlockModel*>(&model)) {
    const auto& states = along->plan().model().states;
    known.insert(known.begin(), states.begin(), states.end());
    for (const Variable& noise : along->plan().model().noise) {
      known.emplace_back("q_" + noise.name, noise.unit);
    }
    for (const Variable& output : model.tables().outputs) {
      known.emplace_back("r_" + output.name, output.unit);
    }
  }
  std::vector<Variable> table;
  for (const std::string& name : track.names) {
    table.push_back(*std::ranges::find(known, name, &Variable::name));
  }
  return table;
}

}  // namespace

TrackedFlight track_aircraft(const AircraftFit& fitted, const Flight& flight,
                             const FlightTrackOptions& options) {
  need_rows_in_time(fitted, "has no states or biases that a filter could begin with");
  AircraftOptions followed = options_on(fitted, flight);
  followed.trajectory.outputs = fitted.options.trajectory.outputs;  // what is logged is tracked
  const LaidAircraft laid = lay(flight, followed);
  return within(flight, [&] {
    if (!laid.along.empty()) {
      throw Error(fmt::format(
          "track takes no effects along a trajectory, as {}; track the fit before it was added",
          laid.along.front().name));
    }
    const StreamStart start = start_of(fitted, flight, laid, options);
    TrackedFlight tracked{.track = track(*laid.model, readings_of(laid), start, options.how),
                          .table = {},
                          .outputs = laid.model->tables().outputs,
                          .file = flight.name(),
                          .notes = laid.notes};
    tracked.table = table_of(tracked.track, *laid.model);
    tracks::set_flight_rows(tracked, laid.flight_rows);
    tracks::note_colour(tracked);
    return tracked;
  });
}

}  // namespace sepcal
