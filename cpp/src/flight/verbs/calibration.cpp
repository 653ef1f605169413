// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <ranges>

#include "base/excerpt.hpp"
#include "base/parameter_values.hpp"
#include "base/sentences.hpp"
#include "estimation/step_times.hpp"
#include "flight/checks/suspect_notes.hpp"
#include "flight/probes/sampled_rows.hpp"
#include "flight/verbs/default_bounds.hpp"
#include "flight/verbs/driver_ranges.hpp"
#include "flight/verbs/held_options.hpp"
#include "flight/verbs/input_noise.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "model/measurements.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/flight/output_file.hpp"
#include "sepcal/detail/flight/probe_effects.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/check.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

namespace {

/// A fit with more parameters than rows is refused, even where three outputs a row would make it
/// solvable: it would calibrate a flight of a few samples.
void check_rows(const BlockModel& model, const CalibrationOptions& options, const Flight& flight,
                std::size_t rows) {
  const std::size_t parameters = model.tables().parameters().size() - options.fit.fix.size();
  if (rows >= parameters) return;
  throw OptionError(
      {fmt::format("{}: {} usable rows are fewer than the {} parameters; log more, or ",
                   flight.name(), rows, parameters),
       Option{"fix"}, " some"});
}

/// Rows that a stage's segments select; messages say of which flight and option.
std::size_t count_rows(const Record& record, const std::string& segments, const Flight& flight,
                       std::string_view stage, const Option& option) {
  try {
    return record.select(segments).rows();
  } catch (const Error& error) {
    throw OptionError({fmt::format("{}: the segments of {} (", flight.name(), stage), option,
                       std::string("): ") + error.what()});
  }
}

/// Standard errors by the delta method. What a fixed parameter gives is certain.
std::vector<Derived> derive(const Probe& probe, const Fit& fit) {
  std::vector<Derived> derived;
  for (const DerivedQuantity& quantity : probe.derive(fit)) {
    std::vector<Eigen::Index> from;
    std::vector<double> slopes;
    for (std::size_t k = 0; k < fit.parameters.size(); ++k) {
      const auto slope = quantity.slopes.find(fit.parameters[k].name);
      if (slope == quantity.slopes.end() || fit.parameters[k].fixed) continue;
      from.push_back(static_cast<Eigen::Index>(k));
      slopes.push_back(slope->second);
    }
    const auto n = static_cast<Eigen::Index>(slopes.size());
    const Eigen::VectorXd g = Eigen::Map<const Eigen::VectorXd>(slopes.data(), n);
    const auto error = [&](const Eigen::MatrixXd& covariance) {
      return n == 0 ? not_a_number : std::sqrt(g.dot(covariance(from, from) * g));
    };
    derived.push_back({.name = quantity.name,
                       .unit = quantity.unit,
                       .value = quantity.value,
                       .standard_error = error(fit.covariance),
                       .standard_error_white = error(fit.covariance_white),
                       .standard_error_noise_model = error(fit.covariance_noise_model),
                       .standard_error_blocks = error(fit.covariance_blocks)});
  }
  return derived;
}

/// Fits the model with its effects and, where it depends on its own output's noise, gives it that
/// of the fit and fits again, until the two agree.
Calibration calibrate_on(const EffectiveFlight& flight, FittedFlight fitted,
                         std::shared_ptr<const Probe> probe, CalibrationOptions held) {
  constexpr double tolerance = 1e-9;  // |noise / noise before - 1|
  constexpr int most_rounds = 20;
  const Record& record = flight.prepared.record;
  FitOptions options = probe->complete(held.fit, record);
  options.unsampled = initial_corrections(flight.effects);
  std::shared_ptr<const BlockModel> model = flight.model;
  const auto set_noise = [&](double noise) {
    std::shared_ptr<const Probe> changed = probe->with_noise(noise);
    if (!changed) return false;
    model = compose(model_of(*changed), flight.effects, record);
    probe = std::move(changed);
    return true;
  };
  double noise = 0.0;
  if (options.noise.size() == 1) {
    noise = options.noise.begin()->second;
    set_noise(noise);
  }
  Fit fit;
  std::optional<StageOne> stage_one;  // of the first round: the others start where it ended
  for (int round = 0; round < most_rounds; ++round) {
    fit = estimation::fit_with_steps(*model, probe->model(), flight.effects, held.effects, record,
                                     options);
    if (!stage_one) stage_one = fit.stage_one;
    const double next = fit.noise.front().value;
    const bool settled = std::abs(next - noise) < tolerance * next;
    const bool hopeless = fit.status != FitStatus::converged && round >= 4;
    if (settled || hopeless) break;
    if (round + 1 == most_rounds) {
      fit.status = FitStatus::not_converged;
      fit.message = base::join_sentences(
          {fit.message, fmt::format("the noise did not settle within {} fits", most_rounds)});
      break;
    }
    if (!set_noise(next)) break;
    noise = next;
    options.start = fit.nonlinear_estimates();
  }
  if (stage_one) fit.stage_one = std::move(*stage_one);
  if (!options.start.empty()) held.fit.samples = 0;
  probe->judge(fit);
  fitted.rows_used = fit.rows;
  std::vector<Derived> derived = derive(*probe, fit);
  std::vector<Restatement> restated = probe->restate(fit);
  std::map<std::string, Interval> ranges =
      ranges_of_drivers(*probe, held.effects, record.select(held.fit.stage_two_segments));
  return {std::move(probe),
          std::move(held),
          std::move(fitted),
          std::move(fit),
          std::move(derived),
          std::move(restated),
          {},
          {},
          flight.prepared.notes,
          {},
          std::move(ranges)};
}

/// What looks at whole columns can't be done where these may be longer than memory.
void check_streamed(const CalibrationOptions& options) {
  const std::string_view why =
      " looks at whole columns, which a streamed log never has in memory; leave it out or fit "
      "without ";
  if (!options.effects.empty()) {
    throw OptionError({Option{"effect"}, std::string(why), Option{"stream"}});
  }
  if (options.fit.loss != Loss::squares) {
    throw OptionError({Option{"loss"}, std::string(why), Option{"stream"}});
  }
}

/// Whether these options do what the note asks for; `rows`: those of the flight that are fitted.
bool is_followed(const LogNote& note, const CalibrationOptions& options, const Flight& flight,
                 const std::vector<std::size_t>& rows) {
  if (note.kind == "outliers" || note.kind == "glitches") {
    return options.fit.loss != Loss::squares;
  }
  if (note.kind == "at_rest") return !options.fit.stage_two_segments.empty();
  if (options.log.drop_repeats.empty()) return false;
  if (note.kind == "held") {  // few of the rows that are left repeat the one before
    const std::span<const double> values = flight.find(note.columns.front())->values;
    std::size_t repeats = 0;
    for (std::size_t i = 1; i < rows.size(); ++i) repeats += values[rows[i]] == values[rows[i - 1]];
    return 10 * repeats < rows.size();
  }
  const auto is_chosen = [&](const std::string& header) {
    return std::ranges::any_of(options.log.drop_repeats, [&](const std::string& name) {
      return probes::is_called(header, name);
    });
  };
  return note.kind == "interpolated" && std::ranges::any_of(note.columns, is_chosen);
}

/// Whether the fit does not have what a note of the check predicts.
bool is_refuted(const LogNote& note, const Fit& fit) {
  constexpr double gross = 0.35;
  if (note.predicts == Predicted::nothing || fit.status != FitStatus::converged) return false;
  return std::ranges::none_of(fit.parameters, [&](const Parameter& parameter) {
    if (parameter.at_bound) return true;
    const bool is_scale = parameter.name == "s_va";
    const bool is_error = parameter.name.starts_with("lambda_");
    return note.predicts == Predicted::scale && (is_scale || is_error) &&
           std::abs(parameter.value - (is_scale ? 1.0 : 0.0)) > gross;
  });
}

/// Whether the readings' notes name the same mend already.
bool is_said(const LogNote& note, const std::vector<std::string>& notes) {
  const std::size_t first = note.advice.find("--map ");
  if (first == std::string::npos) return false;
  const std::string option = note.advice.substr(first, note.advice.find(" reads") - first);
  return std::ranges::any_of(
      notes, [&](const std::string& said) { return said.find(option) != std::string::npos; });
}

/// Adds what check() says that is worth a word, and that the fit does not refute.
void note_check(const Probe& probe, const PreparedFlight& prepared,
                const CalibrationOptions& options, const Fit& fit,
                std::vector<std::string>& notes) {
  const Flight& flight = prepared.logged;
  if (flight.is_mapped() && flight.rows() > base::excerpt_rows) {
    notes.push_back(fmt::format(
        "{}: not checked, since a check takes whole columns into memory: check a part of the log",
        flight.name()));
    return;
  }
  FlightCheck seen = check(probe, flight,
                           {.drop_invalid = options.log.drop_invalid,
                            .where = options.log.where,
                            .from_time = options.log.from_time,
                            .to_time = options.log.to_time});
  std::erase_if(seen.notes, [&](const LogNote& note) {
    return is_refuted(note, fit) || is_said(note, prepared.readings.notes) ||
           is_followed(note, options, flight, prepared.readings.flight_rows);
  });
  std::ranges::move(brief_notes(seen), std::back_inserter(notes));
}

/// A status other than converged where it can't be done.
Fit refit_where_possible(const Calibration& calibration, const PreparedFlight& prepared,
                         const CalibrationOptions& options) {
  try {
    if (options.log == calibration.options.log) {
      return verbs::calibrate(calibration.probe, prepared, options).fit;
    }
    const PreparedFlight fewer = prepare(*calibration.probe, prepared.logged, options.log);
    return verbs::calibrate(calibration.probe, fewer, options).fit;
  } catch (const Error&) {
    return {};
  }
}

/// What the rows that are no readings do to the answer: one more fit tells, with a loss that
/// forgets them, or without them where they are too many in a row for a loss.
void note_pull(Calibration& calibration, const PreparedFlight& prepared,
               const CalibrationOptions& options) {
  if (prepared.measured.condition.empty() || options.fit.loss != Loss::squares) return;
  CalibrationOptions other = options;
  const std::string where =
      checks::join_conditions(options.log.where, {prepared.measured.condition});
  if (prepared.loss_helps) {
    other.fit.loss = Loss::cauchy;
  } else {
    other.log.where = where;
  }
  const Fit fit = refit_where_possible(calibration, prepared, other);
  const Parameter* farthest = nullptr;
  double most = 0.0;
  for (const Parameter& parameter : calibration.fit.parameters) {
    if (fit.status != FitStatus::converged) break;
    const double shift = (fit[parameter.name].value - parameter.value) / parameter.standard_error;
    if (!(std::abs(shift) > most)) continue;
    farthest = &parameter;
    most = std::abs(shift);
  }
  constexpr double little = 0.1;  // standard errors: rows that the fit dropped anyway
  if (fit.status == FitStatus::converged && most < little) return;
  const std::string way = prepared.loss_helps ? "with --loss cauchy" : "without them";
  const std::string moved =
      farthest == nullptr
          ? fmt::format("a fit {} tells by how much", way)
          : fmt::format("{} {} is {:.4g} and not {:.4g}, {:.2g} standard errors away", way,
                        farthest->name, fit[farthest->name].value, farthest->value, most);
  calibration.notes.push_back(fmt::format(
      "{}: rows in which {} can't be a reading pull the fit: {}; fit again {}--where \"{}\"",
      prepared.logged.name(), prepared.measured.columns, moved,
      prepared.loss_helps ? "with --loss cauchy, or without them: " : "with ", where));
}

/// What a delay's reach takes from the segments' ends, where that is much.
void note_edges(const Record& whole, const EffectiveFlight& flight, const FitOptions& options,
                std::vector<std::string>& notes) {
  constexpr double much = 0.1;
  const auto rows = static_cast<double>(whole.rows());
  const std::size_t lost = whole.rows() - flight.prepared.record.rows();
  if (!(static_cast<double>(lost) > much * rows)) return;
  notes.push_back(fmt::format(
      "{} of {} rows lie within {:.3g} s of the end of a segment, where a delay can't be followed "
      "to its bounds, and are left out; narrower bounds keep more",
      lost, whole.rows(), reach(flight.effects, options.bounds)));
}

/// The probe for a fit of these rows. Throws Error for a fit that none of its verbs could follow.
std::shared_ptr<const Probe> laid_along(const std::shared_ptr<const Probe>& probe,
                                        const Record& record, const CalibrationOptions& options) {
  std::shared_ptr<const Probe> laid = probe->along(record);
  if (!laid) return probe;
  if (options.fit.method == FitMethod::filter_error) {
    throw Error(fmt::format(
        "a flight of {} is fitted by output error; by filter error give sepcal.fit() or fit() the "
        "model's columns",
        probe->name()));
  }
  return laid;
}

/// The fit within the bounds that the options give and the model has by default.
Calibration calibrate_within(std::shared_ptr<const Probe> probe, const PreparedFlight& prepared,
                             const CalibrationOptions& options) {
  const Flight& flight = prepared.flight;
  CalibrationOptions held = hold(*probe, options);
  const EffectiveFlight effective = with_effects(*probe, flight, prepared.readings, held.effects,
                                                 options.own_effects, options.fit.bounds);
  const Record& record = effective.prepared.record;
  count_rows(record, options.fit.stage_one_segments, flight, "stage one", {"stage_one_segments"});
  check_rows(*effective.model, held, flight,
             count_rows(record, options.fit.stage_two_segments, flight, "stage two",
                        {"stage_two_segments"}));
  FittedFlight fitted{flight.name(), digest(*probe, prepared), flight.rows(), 0};
  Calibration calibration =
      calibrate_on(effective, std::move(fitted), std::move(probe), std::move(held));
  note_edges(prepared.readings.record, effective, options.fit, calibration.notes);
  std::string suggestion =
      flight.is_mapped() ? "" : calibration.probe->suggest(calibration.fit, record);
  if (!suggestion.empty()) {
    calibration.notes.push_back(flight.name() + ": " + std::move(suggestion));
  }
  return calibration;
}

/// The fit with the probe's parameters let beyond default bounds where one of them ended, if the
/// data determine it there; of an effect's parameters, and where a strength or a unit looks wrong,
/// only what to give.
Calibration try_beyond(Calibration within, const std::shared_ptr<const Probe>& probe,
                       const PreparedFlight& prepared, const CalibrationOptions& options) {
  const Bounds tried = find_bounds_beyond(within.fit, options.fit.bounds);
  if (tried.empty()) return within;
  CalibrationOptions wider = options;
  wider.fit.bounds.insert(tried.begin(), tried.end());
  std::optional<Calibration> beyond;
  try {
    beyond = calibrate_within(probe, prepared, wider);
  } catch (const Error&) {  // too few rows within a longer delay's reach, say
    return within;
  }
  if (!is_regular_beyond(tried, within.fit, beyond->fit)) return within;
  const std::vector<Variable> own = lasting_parameters(*probe);
  const bool adopted =
      has_plausible_scales(beyond->fit) && std::ranges::all_of(tried, [&](const auto& bound) {
        return std::ranges::find(own, bound.first, &Variable::name) != own.end();
      });
  const std::string sentence = describe_beyond(tried, within.fit, beyond->fit, adopted);
  Calibration& kept = adopted ? *beyond : within;
  kept.fit.message = base::join_sentences({sentence, kept.fit.message});
  return std::move(kept);
}

}  // namespace

Calibration calibrate(std::shared_ptr<const Probe> probe, const Flight& flight,
                      const CalibrationOptions& options) {
  if (flight.is_mapped()) check_streamed(options);
  if (std::shared_ptr<const Probe> settled = probe->settle(flight, options.log)) {
    probe = std::move(settled);
  }
  const PreparedFlight prepared = prepare(*probe, flight, options.log);
  Calibration calibration = calibrate(probe, prepared, options);
  std::vector<std::string> notes;
  note_check(*probe, prepared, options, calibration.fit, notes);
  std::ranges::copy(prepared.filled, std::back_inserter(calibration.notes));
  std::ranges::move(notes, std::back_inserter(calibration.notes));
  note_pull(calibration, prepared, options);
  note_input_noise(calibration, prepared);
  return calibration;
}

Calibration verbs::calibrate(const std::shared_ptr<const Probe>& given,
                             const PreparedFlight& prepared, const CalibrationOptions& options) {
  const std::shared_ptr<const Probe> probe = laid_along(given, prepared.readings.record, options);
  return try_beyond(calibrate_within(probe, prepared, options), probe, prepared, options);
}

Calibration calibrate(std::shared_ptr<const Probe> probe, const Record& record,
                      const CalibrationOptions& options) {
  probe = laid_along(probe, record, options);
  CalibrationOptions held = hold(*probe, options);
  const EffectiveFlight effective =
      with_effects(*probe, model::with_constant_outputs(probe->model().tables(), record),
                   held.effects, options.own_effects, options.fit.bounds);
  return calibrate_on(effective, {{}, {}, record.length(), 0}, std::move(probe), std::move(held));
}

Eigen::VectorXd own_values(const Calibration& calibration) {
  return base::in_order(calibration.probe->model().tables().parameters(),
                        calibration.fit.by_name());
}

void write_calibration(const Calibration& calibration, const std::string& file) {
  OutputFile output(file);
  output.write(to_json(calibration));
  output.commit();
}

}  // namespace sepcal
