// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/track.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>

#include "base/name_list.hpp"
#include "flight/tracks/tracked_rows.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/flight/joint.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace verbs;  // the room below

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// (R'R)^-1
MatrixXd covariance_of(const MatrixXd& R) {
  const MatrixXd inverse =
      R.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(R.rows(), R.cols()));
  return inverse * inverse.transpose();
}

/// Where a parameter stands among those that are estimated. Throws Error where it doesn't.
Index place_of(const StreamStart& start, const std::string& name) {
  std::vector<std::string> names;
  for (const int k : start.free) names.push_back(start.names[static_cast<std::size_t>(k)]);
  const auto at = std::ranges::find(names, name);
  if (at != names.end()) return at - names.begin();
  throw OptionError({Option{"own"}, ": '" + name + "' is not estimated; there are " +
                                        base::list_first(names, 12)});
}

/// The calibration's start with `own` where first rows have them, all else held, and so wide that
/// these rows may be followed once more: ten of their standard errors, a hundredth of what they
/// tell.
StreamStart with_own(const Calibration& calibration, const EffectiveFlight& effective,
                     FitOptions fit, const FlightTrackOptions& options) {
  constexpr double wide = 10.0;
  StreamStart start = start_from_fit(calibration.fit);
  MatrixXd P = covariance_of(start.R);
  for (const std::string& name : options.own) place_of(start, name);
  for (std::size_t k = 0; k < start.names.size(); ++k) {
    const std::string& name = start.names[k];
    if (std::ranges::find(options.own, name) == options.own.end()) {
      fit.fix[name] = start.xi[static_cast<Index>(k)];
      fit.bounds.erase(name);
      fit.prior.erase(name);
    }
  }
  const StreamStart found =
      start_from_rows(*effective.model, effective.prepared.record, options.start_rows, fit);
  const MatrixXd own = covariance_of(found.R);
  for (const std::string& name : options.own) {
    const Index from = place_of(found, name);
    const Index to = place_of(start, name);
    start.xi[start.free[static_cast<std::size_t>(to)]] =
        found.xi[found.free[static_cast<std::size_t>(from)]];
    P.row(to).setZero();
    P.col(to).setZero();
    P(to, to) = wide * wide * own(from, from);
  }
  const MatrixXd information = P.ldlt().solve(MatrixXd::Identity(P.rows(), P.cols()));
  start.R = information.llt().matrixU();
  return start;
}

StreamStart start_of(const Calibration& calibration, const Flight& flight,
                     const EffectiveFlight& effective, FlightTrackOptions options) {
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
  if (const auto wind = std::ranges::find(options.own, "wind"); wind != options.own.end()) {
    const std::vector<std::string> components = resolve_own(*calibration.probe, {"wind"});
    options.own.insert(options.own.erase(wind), components.begin(), components.end());
  }
  if (!options.own.empty()) return with_own(calibration, effective, std::move(fit), options);
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
  const std::vector<Variable> known = effective.model->tables().parameters();
  const bool has_wind = std::ranges::find(known, "w_n", &Variable::name) != known.end();
  if (options.start_rows == 0 && has_wind) {
    tracked.notes.emplace_back(
        "every parameter begins as the calibration has it, the wind of its flight too; find what "
        "is this flight's own in its first rows: --start-rows N --own wind");
  }
  const StreamStart start = start_of(calibration, flight, effective, options);
  tracked.track = sepcal::track(*effective.model, record, start, options.how);
  for (const std::string& name : tracked.track.names) {
    tracked.table.push_back(*std::ranges::find(known, name, &Variable::name));
  }
  tracks::place_in_flight(tracked, prepared.readings.flight_rows);
  return tracked;
}

}  // namespace sepcal
