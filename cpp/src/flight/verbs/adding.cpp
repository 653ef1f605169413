// SPDX-License-Identifier: BSD-3-Clause
// The step from one calibration to the next: an effect is added, everything is fitted again from
// where the last fit ended, and the error before and after goes into the history.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parameter_values.hpp"
#include "base/thread_pool.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "model/measurements.hpp"
#include "model/sweep.hpp"
#include "sepcal/effect_name.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/comparison.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

namespace {

using Eigen::VectorXd;

/// Squares of a calibration's residuals, summed over the rows of `record`, an output each.
struct Squares {
  VectorXd sums;
  double rows = 0.0;

  double total(const VectorXd& units) const {
    const double all = sums.cwiseQuotient(units.cwiseAbs2()).sum();
    return std::sqrt(all / (rows * static_cast<double>(sums.size())));
  }
};

Squares squares_of(const Calibration& calibration, const EffectiveFlight& flight,
                   const Record& record) {
  const model::Measurements measurements(*flight.model, record);
  base::ThreadPool pool(calibration.options.fit.threads);
  const model::Sweep sweep(*flight.model, measurements, pool);
  return {sweep.squared_residuals(calibration.fit.xi1(), calibration.fit.xi2()),
          static_cast<double>(measurements.rows())};
}

/// Where the outputs have several units, what the errors of a step start at, so that a chain goes
/// on where it ended; each output's own RMSE before it is the unit of that. Else 1.
double start_of_step(const Calibration& base) {
  const bool one_unit = !base.probe->model().tables().output_unit().empty();
  return one_unit || base.history.empty() ? 1.0 : base.history.back().rmse_after;
}

VectorXd units_of_step(const Calibration& base, const Squares& before) {
  VectorXd units = VectorXd::Ones(before.sums.size());
  if (!base.probe->model().tables().output_unit().empty()) return units;
  for (Eigen::Index j = 0; j < units.size(); ++j) {
    if (before.sums[j] > 0.0) {
      units[j] = std::sqrt(before.sums[j] / before.rows) / start_of_step(base);
    }
  }
  return units;
}

void refuse_twice(const CalibrationOptions& options) {
  std::vector<std::string> names;
  for (const EffectSetting& setting : options.effects) names.push_back(setting.name);
  std::ranges::sort(names);
  const auto twice = std::ranges::adjacent_find(names);
  if (twice == names.end()) return;
  throw Error(fmt::format("the calibration has the effect {} already", *twice));
}

/// What the effect promised at the base's estimates; nothing where it can't be tried there.
Promise promise_of(const Calibration& base, const Calibration& next, const PreparedFlight& prepared,
                   const std::string& effect) {
  try {
    return promise(diagnosed_fit(base, prepared.readings.record, next.options.own_effects), effect,
                   next.fit.by_name(), base.options.fit.threads);
  } catch (const Error&) {
    return {};
  }
}

/// The base's model with the effect.
Calibration refit(const Calibration& base, const PreparedFlight& prepared,
                  const std::string& effect, const OwnEffects& own, const FitProgress& progress) {
  CalibrationOptions options = options_from(base, own, progress);
  for (const std::string& name : split_effects(effect)) options.effects.push_back({.name = name});
  refuse_twice(options);
  Calibration next = calibrate(base.probe, prepared, options);
  refuse_twice(next.options);  // now that aliases are resolved
  return next;
}

Calibration add_to(const Calibration& base, const PreparedFlight& prepared,
                   const std::string& effect, const OwnEffects& own, const FitProgress& progress) {
  Calibration next = refit(base, prepared, effect, own, progress);
  const EffectiveFlight after = with_effects_of(next, prepared);
  const Record& record = after.prepared.record.select(next.options.fit.stage_two_segments);
  const EffectiveFlight before = with_effects_of(base, prepared);
  std::string added;
  for (std::size_t i = base.options.effects.size(); i < next.options.effects.size(); ++i) {
    added += (added.empty() ? "" : "+") + next.options.effects[i].name;
  }
  Record rows = before.prepared.record;
  rows.cut(record.segments());
  const Promise promised = promise_of(base, next, prepared, added);
  if (!promised.against.empty()) {
    next.notes.push_back(fmt::format("diagnose would not advise {}: {}", added, promised.against));
  }
  next.history = base.history;
  const Squares squares = squares_of(base, before, rows);
  const VectorXd units = units_of_step(base, squares);
  const double start = start_of_step(base);
  next.history.push_back({.effect = added,
                          .rmse_before = squares.total(units),
                          .rmse_after = squares_of(next, after, record).total(units),
                          .held_out_before = start * promised.held_out_before,
                          .held_out_after = start * promised.held_out_after,
                          .predicted_drop = promised.predicted_drop});
  return next;
}

}  // namespace

Calibration verbs::add_effect(const Calibration& base, const Flight& flight,
                              const std::string& effect, const OwnEffects& own,
                              const FitProgress& progress) {
  PreparedFlight prepared = prepare(base, flight);
  const OnFlight here = on_readings_of(along(base, prepared), flight, prepared, own, progress);
  note_mended(prepared);
  Calibration next = add_to(here.calibration, prepared, effect, own, progress);
  next.notes.insert(next.notes.begin(), here.notes.begin(), here.notes.end());
  return next;
}

Calibration add(const Calibration& base, const Flight& flight, const std::string& effect,
                const OwnEffects& own, const FitProgress& progress) {
  Calibration next = add_effect(base, flight, effect, own, progress);
  next.probe->judge_flights(next, flight);
  return next;
}

Comparison compare_with(const Calibration& base, const Flight& flight, const std::string& effect) {
  PreparedFlight prepared = prepare(base, flight);
  return compare(refit(along(base, prepared), prepared, effect, {}, {}), flight);
}

}  // namespace sepcal
