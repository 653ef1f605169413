// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/prepared_flight.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "flight/checks/suspect_notes.hpp"
#include "flight/files/flight_digest.hpp"
#include "flight/logs/chosen_columns.hpp"
#include "flight/probes/joined_quantities.hpp"
#include "flight/verbs/input_noise.hpp"
#include "flight/verbs/residual_comparison.hpp"
#include "sepcal/error.hpp"

namespace sepcal::verbs {

PreparedFlight prepare(const Probe& probe, const Flight& flight, const LogChoice& log) {
  ReadFlight read = probes::read_for(probe, flight, log);
  MendedFlight mended = mend(probe, read.flight, log);
  ProbeRecord readings = probe.prepare(mended.flight, log);
  readings.notes.insert(readings.notes.begin(), read.notes.begin(), read.notes.end());
  if (log.smooth_inputs) take_out_input_noise(probe, flight.name(), readings);
  return {std::move(mended.flight),  std::move(readings),      std::move(read.flight),
          std::move(mended.bridged), std::move(mended.filled), std::move(mended.measured),
          std::move(mended.all),     std::move(mended.slow),   mended.loss_helps};
}

PreparedFlight prepare(const Calibration& calibration, const Flight& flight) {
  std::vector<std::string> notes;
  const LogChoice choice = choice_for(calibration, flight, notes);
  PreparedFlight prepared = prepare(*calibration.probe, flight, choice);
  auto& all = prepared.readings.notes;
  all.insert(all.begin(), notes.begin(), notes.end());
  return prepared;
}

std::string digest(const Probe& probe, const PreparedFlight& prepared) {
  const Flight& logged = prepared.logged;
  return probe.initial_states().empty() ? logged.sha256() : files::digest_of(logged);
}

Calibration along(const Calibration& given, PreparedFlight& prepared) {
  std::shared_ptr<const Probe> probe = given.probe->along(prepared.readings.record);
  if (!probe) return given;
  Calibration here = given;
  here.probe = std::move(probe);
  const auto is_initial = [&](const std::string& name) {
    return is_initial_state(*here.probe, name);
  };
  std::set<std::string> fitted;
  for (const Parameter& one : given.fit.parameters) {
    if (is_initial(one.name)) fitted.insert(one.name);
  }
  std::set<std::string> there;
  for (const Variable& one : here.probe->model().tables().parameters()) {
    if (is_initial(one.name)) there.insert(one.name);
  }
  if (given.flight.sha256 == digest(*here.probe, prepared) && fitted == there) return here;
  prepared.readings.notes.push_back(fmt::format(
      "{}: the rows are not those of the fit: the initial states are estimated anew, all else is "
      "held",
      prepared.flight.name()));
  CalibrationOptions options = given.options;
  FitOptions& fit = options.fit;
  for (const auto drop : {&FitOptions::start, &FitOptions::fix}) {
    std::erase_if(fit.*drop, [&](const auto& entry) { return is_initial(entry.first); });
  }
  std::erase_if(fit.bounds, [&](const auto& entry) { return fitted.contains(entry.first); });
  std::erase_if(fit.prior, [&](const auto& entry) { return fitted.contains(entry.first); });
  for (const Parameter& one : given.fit.parameters) {
    if (!is_initial(one.name)) fit.fix[one.name] = one.value;
  }
  for (const auto& [name, value] : fit.fix) {
    fit.start.erase(name);
    fit.prior.erase(name);
  }
  for (const OutputValue& noise : given.fit.noise) fit.noise[noise.name] = noise.value;
  fit.stage_one_segments.clear();
  fit.stage_two_segments.clear();
  here.fit = calibrate(here.probe, prepared, options).fit;
  here.fit.status = given.fit.status;
  here.fit.message = given.fit.message;
  for (Parameter& one : here.fit.parameters) {
    if (!is_initial(one.name)) one = given.fit[one.name];
  }
  return here;
}

LogChoice choice_for(const Calibration& calibration, const Flight& flight,
                     std::vector<std::string>& notes) {
  LogChoice choice = calibration.options.log;
  if (!is_other_flight(calibration, flight)) return choice;
  // Another log may have sepcal's names already, and lack what was in the way.
  std::erase_if(choice.map, [&](const auto& names) {
    return !logs::find_mapped(flight, names.second) && flight.find(names.first) != nullptr;
  });
  std::erase_if(choice.ignore, [&](const std::string& header) {
    return flight.find(header) == nullptr && !choice.map.contains(header);
  });
  if (!choice.from_time && !choice.to_time) return choice;
  notes.push_back(fmt::format(
      "{}: the times that the calibration was fitted within are of another log's clock: all times "
      "count here",
      flight.name()));
  choice.from_time = choice.to_time = std::nullopt;
  return choice;
}

EffectiveFlight with_effects_of(const Calibration& calibration, const PreparedFlight& prepared) {
  const CalibrationOptions& options = calibration.options;
  std::vector<EffectSetting> settings = options.effects;
  EffectiveFlight effective = with_effects(*calibration.probe, prepared.flight, prepared.readings,
                                           settings, options.own_effects, options.fit.bounds);
  if (!std::ranges::equal(calibration.fit.parameters, effective.model->tables().parameters(), {},
                          &Parameter::name, &Variable::name)) {
    throw Error(
        "the calibration's parameters are not those of its model with its effects; fit the "
        "flight again");
  }
  return effective;
}

Eigen::MatrixXd residuals_of(const Calibration& calibration, const EffectiveFlight& effective,
                             base::ThreadPool& pool) {
  return residuals_of(*effective.model, effective.prepared.record, calibration.fit, pool);
}

namespace {

/// Without errors of inputs that the flight doesn't log: of a field that is known in body axes no
/// attitude wanders.
EffectKit kit_for(const Probe& probe, const OwnEffects& own, const Record& readings) {
  EffectKit kit = effect_kit(probe, own);
  std::erase_if(kit.attitude_errors, [&](const EffectKit::Maker& maker) {
    Record record = readings;
    EffectSetting setting{.name = "attitude_error"};
    const Effect effect = maker(probe.model(), setting, record);
    return std::ranges::any_of(effect.corrections, [&](const auto& correction) {
      return std::ranges::any_of(correction->inputs(), [&](const Variable& input) {
        return !record.has(input.name) && !std::isfinite(input.absent);
      });
    });
  });
  return kit;
}

}  // namespace

DiagnosedFit diagnosed_fit(const Calibration& calibration, const Record& readings,
                           const OwnEffects& own) {
  const Probe& probe = *calibration.probe;
  std::vector<EffectSetting> settings = calibration.options.effects;
  const EffectiveFlight effective =
      with_effects(probe, readings, settings, own, calibration.options.fit.bounds);
  return {
      .model = model_of(probe),
      .kit = kit_for(probe, own, readings),
      .effects = std::move(settings),
      .record = readings,
      .rows =
          effective.prepared.record.select(calibration.options.fit.stage_two_segments).segments(),
      .fit = calibration.fit};
}

bool is_other_flight(const Calibration& calibration, const Flight& flight) {
  const std::string& fitted = calibration.flight.sha256;
  return !fitted.empty() && !flight.sha256().empty() && fitted != flight.sha256();
}

void check_fitted(const Calibration& calibration, const Flight& flight) {
  if (!is_other_flight(calibration, flight)) return;
  throw Error(fmt::format(
      "{}: not the flight that the calibration was fitted to, {}; what is asked is of a fit: give "
      "its flight, or fit this one",
      flight.name(), calibration.flight.file));
}

void note_other_flight(const Calibration& calibration, const Flight& flight,
                       std::vector<std::string>& notes) {
  if (!is_other_flight(calibration, flight)) return;
  notes.push_back(fmt::format(
      "{}: not the flight that the calibration was fitted to, {}; the errors here are those of a "
      "prediction",
      flight.name(), calibration.flight.file));
}

CalibrationOptions options_from(const Calibration& base, const OwnEffects& own,
                                const FitProgress& progress) {
  CalibrationOptions options = base.options;
  options.fit.progress = progress;
  options.fit.start = base.fit.nonlinear_estimates();
  for (const auto& [name, maker] : own) options.own_effects[name] = maker;
  return options;
}

void note_mended(PreparedFlight& prepared) {
  std::ranges::copy(prepared.bridged, std::back_inserter(prepared.readings.notes));
  std::ranges::copy(prepared.filled, std::back_inserter(prepared.readings.notes));
}

std::optional<Calibration> without_suspects(const Calibration& base, PreparedFlight& prepared,
                                            const OwnEffects& own, const FitProgress& progress) {
  const bool is_slow = !prepared.slow.empty() && base.options.log.drop_repeats.empty();
  if (prepared.all.condition.empty() && !is_slow) return std::nullopt;
  const Flight& flight = prepared.logged;
  Calibration left = base;
  if (!prepared.all.condition.empty()) {
    std::string& where = left.options.log.where;
    where = checks::join_conditions(where, {prepared.all.condition});
  }
  if (is_slow) left.options.log.drop_repeats = prepared.slow;
  try {
    PreparedFlight again = prepare(left, flight);
    CalibrationOptions options = options_from(left, own, progress);
    options.fit.start = base.options.fit.start;  // what the others led to is no place to begin
    left = calibrate(base.probe, again, options);
    prepared = std::move(again);
  } catch (const Error&) {
    return std::nullopt;  // what is left is no flight
  }
  left.file = base.file;
  left.history = base.history;
  left.notes = {};
  return left;
}

std::string say_left_out(const std::string& flight, const LogChoice& now,
                         const RowsToLeave& suspected, const std::vector<std::string>& slow) {
  std::vector<std::string> rows;
  std::vector<std::string> options;
  if (!suspected.condition.empty()) {
    rows.push_back(fmt::format("in which {} can't be a reading", suspected.columns));
    options.push_back(fmt::format("--where \"{}\"", now.where));
  }
  if (!slow.empty() && slow == now.drop_repeats) {
    rows.push_back(fmt::format("between the samples of {}", fmt::join(slow, ", ")));
    options.push_back(fmt::format("--drop-repeats {}", fmt::join(slow, ",")));
  }
  return fmt::format(
      "{}: rows {} are left out, and the calibration is fitted again without them, as fit does "
      "with {}",
      flight, fmt::join(rows, " and "), fmt::join(options, " "));
}

Calibration refit_to(const Calibration& base, const PreparedFlight& prepared, const OwnEffects& own,
                     const FitProgress& progress) {
  Calibration here = calibrate(base.probe, prepared, options_from(base, own, progress));
  here.history = base.history;
  here.notes = {fmt::format(
      "{}: not the flight that the calibration was fitted to, {}; it was fitted to this one before "
      "the effect was added",
      prepared.flight.name(), base.flight.file)};
  return here;
}

OnFlight on_readings_of(const Calibration& base, const Flight& flight, PreparedFlight& prepared,
                        const OwnEffects& own, const FitProgress& progress) {
  OnFlight here{base, {}};
  if (is_other_flight(base, flight)) {
    here.calibration = refit_to(base, prepared, own, progress);
    here.notes = here.calibration.notes;
  }
  const RowsToLeave suspected = prepared.all;
  const std::vector<std::string> slow = prepared.slow;
  if (const auto left = without_suspects(here.calibration, prepared, own, progress)) {
    here.calibration = *left;
    here.notes.push_back(say_left_out(flight.name(), left->options.log, suspected, slow));
  }
  return here;
}

}  // namespace sepcal::verbs
