// SPDX-License-Identifier: BSD-3-Clause
// Estimates of an aircraft against time: a fit's model followed by a recursive estimator.
#include <fmt/format.h>

#include <algorithm>

#include "flight/aircraft/laid_aircraft.hpp"
#include "flight/tracks/tracked_rows.hpp"
#include "sepcal/aircraft/two_step.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/aircraft.hpp"

namespace sepcal {

using namespace aircraft_log;  // this room's own

namespace {

/// Throws OptionError where a track would begin with the fit of its own rows.
void check_start(const AircraftFit& fitted, const Flight& flight, const FlightTrackOptions& how) {
  if (how.start_rows > 0 || !is_same_flight(fitted, flight)) return;
  throw OptionError(
      {"the fit is of this flight, whose rows must not count twice; start from its first ones, by ",
       Option{"start_rows"}});
}

StreamStart start_of(const AircraftFit& fitted, const Flight& flight, const LaidAircraft& laid,
                     const FlightTrackOptions& how) {
  check_start(fitted, flight, how);
  const std::size_t rows = how.start_rows;
  if (rows == 0) return start_from_fit(fitted.fit);
  AircraftOptions options = fitted.options;
  options.calibration.fit = fit_of_start(*laid.model, options.calibration.fit, how.how);
  if (laid.initial_states.empty()) {
    return start_from_rows(*laid.model, readings_of(laid), rows, options.calibration.fit);
  }
  for (const std::string& name : fitted.initial_states) {  // of other segments than the first rows'
    options.calibration.fit.start.erase(name);
  }
  const LaidAircraft batch = lay_first_rows(flight, options, rows);
  return start_from_rows(*batch.model, readings_of(laid), rows, batch.fit);
}

/// Of the path: all but what is of the coefficients.
TrackOptions first_of(const FlightTrackOptions& options, const Fit& aero) {
  TrackOptions path = options.how;
  path.changes = TrackChanges::ignore;
  path.forgetting = 1.0;
  path.memory = 0.0;
  path.band = {};
  for (const Parameter& parameter : aero.parameters) path.walk.erase(parameter.name);
  return path;
}

TrackOptions second_of(const FlightTrackOptions& options, const Fit& aero) {
  TrackOptions second{.method = options.second,
                      .changes = options.how.changes,
                      .forgetting = options.how.forgetting,
                      .memory = options.how.memory,
                      .band = options.how.band};
  for (const Parameter& parameter : aero.parameters) {
    const auto walk = options.how.walk.find(parameter.name);
    if (walk != options.how.walk.end()) second.walk.insert(*walk);
  }
  return second;
}

/// One track of both: the path's columns, then those of the coefficients, at the rows of both.
Track side_by_side(Track path, Track aero) {
  const auto join = [](Eigen::MatrixXd& left, const Eigen::MatrixXd& right) {
    const Eigen::Index before = left.cols();
    left.conservativeResize(Eigen::NoChange, before + right.cols());
    left.rightCols(right.cols()) = right;
  };
  path.names.insert(path.names.end(), aero.names.begin(), aero.names.end());
  join(path.estimates, aero.estimates);
  join(path.standard_deviations, aero.standard_deviations);
  join(path.innovations, aero.innovations);
  path.changes = std::move(aero.changes);
  path.refused += aero.refused;
  path.not_converged += aero.not_converged;
  return path;
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
    tracks::place_in_flight(tracked, laid.flight_rows);
    return tracked;
  });
}

TrackedFlight track_two_steps(const TwoStepFit& fitted, const Flight& flight,
                              const FlightTrackOptions& options) {
  if (options.second == TrackMethod::rml || options.second == TrackMethod::iekf) {
    throw OptionError({Option{"second"}, " is rls, ekf, srif or rft: coefficients are linear"});
  }
  if (!is_filter(options.how.method)) {
    throw OptionError({Option{"method"}, " of two steps is the path's: ekf, iekf or srif"});
  }
  check_start(fitted.path, flight, options);
  const AircraftOptions path = options_on(fitted.path, flight);
  const ProbeRecord prepared = prepare(flight, two_step_columns(path), path.calibration.log);
  return within(flight, [&] {
    TwoStepOptions steps{.equations = fitted.aero.equations,
                         .path = path.trajectory,
                         .position = path.position,
                         .gravity = path.gravity,
                         .window = fitted.aero.options.window,
                         .path_fit = path.calibration.fit,
                         .free = path.calibration.free};
    if (!options.how.noise.empty()) steps.path_fit.noise = options.how.noise;
    if (!options.how.process_noise.empty()) {
      steps.path_fit.process_noise = options.how.process_noise;
    }
    const AircraftGeometry& geometry = geometry_of(fitted.aero.options);
    const TwoStepStart start =
        options.start_rows > 0
            ? start_two_steps(prepared.record, geometry, options.start_rows, steps)
            : TwoStepStart{start_from_fit(fitted.path.fit), start_from_fit(fitted.aero.fit)};
    TwoStepTrack found =
        track_two_steps(prepared.record, geometry, start, steps, first_of(options, fitted.aero.fit),
                        second_of(options, fitted.aero.fit));
    TrackedFlight tracked{.track = side_by_side(std::move(found.path), std::move(found.aero)),
                          .table = std::move(found.table),
                          .outputs = std::move(found.outputs),
                          .file = flight.name(),
                          .notes = prepared.notes};
    tracks::place_in_flight(tracked, prepared.flight_rows);
    return tracked;
  });
}

}  // namespace sepcal
