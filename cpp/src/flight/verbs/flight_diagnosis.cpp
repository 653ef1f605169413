// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/flight_diagnosis.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/short_number.hpp"
#include "base/thread_pool.hpp"
#include "flight/catalogue/effect_candidates.hpp"
#include "flight/checks/suspect_notes.hpp"
#include "flight/checks/taken_rows.hpp"
#include "flight/verbs/curved_candidates.hpp"
#include "flight/verbs/injection.hpp"
#include "flight/verbs/misfits.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/flight/effect_catalogue.hpp"
#include "sepcal/detail/flight/probe_effects.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

namespace {

using Eigen::MatrixXd;

/// The calibration's own effects and the caller's.
OwnEffects all_own(const Calibration& calibration, const OwnEffects& own) {
  OwnEffects all = calibration.options.own_effects;
  for (const auto& [name, maker] : own) all[name] = maker;
  return all;
}

/// Those of the catalogue and those that the residual asks for.
std::vector<std::string> pool_of(const catalogue::EffectTable& table, const DiagnosedFit& fitted,
                                 const Flight& flight, int threads) {
  std::vector<std::string> names =
      catalogue::list_candidates(table, fitted.kit, fitted.record, flight);
  base::ThreadPool pool(threads);
  for (std::string& name :
       find_curved(fitted, catalogue::list_drivers(table, fitted.record, flight), pool)) {
    const std::string_view in_time = "[spline(time,";
    const std::size_t at = name.find(in_time);
    const auto is_known = [&](const std::string& other) {
      return other == name ||
             (at != std::string::npos && other.starts_with(name.substr(0, at + in_time.size())));
    };
    if (std::ranges::none_of(names, is_known)) names.push_back(std::move(name));
  }
  return names;
}

/// Those of the pool, or of `only`, that the calibration doesn't have yet.
std::vector<std::string> candidates_for(const catalogue::EffectTable& table,
                                        const DiagnosedFit& fitted, const Flight& flight,
                                        const DiagnosisOptions& options) {
  std::vector<std::string> names =
      options.only.empty() ? pool_of(table, fitted, flight, options.threads) : options.only;
  std::erase_if(names, [&](const std::string& name) {
    return std::ranges::find(fitted.effects, name, &EffectSetting::name) != fitted.effects.end();
  });
  return names;
}

/// Names of the probe's catalogue: of effects that do the same they are the ones people know.
std::vector<std::string> catalogued(const Probe& probe) {
  std::vector<std::string> names;
  for (const CataloguedEffect& effect : effect_catalogue(probe)) names.push_back(effect.name);
  return names;
}

FlightDiagnosis run(const Calibration& calibration, const PreparedFlight& prepared,
                    const OwnEffects& own, const DiagnosisOptions& options) {
  const Flight& flight = prepared.flight;
  const DiagnosedFit fitted = diagnosed_fit(calibration, prepared.readings.record, own);
  const catalogue::EffectTable& table = calibration.probe->effects();
  FlightDiagnosis result;
  result.model = calibration.probe->name();
  result.app = calibration.probe->app();
  result.calibration = calibration.file;
  result.status = calibration.fit.status;
  result.message = calibration.fit.message;
  result.notes = prepared.readings.notes;
  note_other_flight(calibration, flight, result.notes);
  DiagnosisOptions preferring = options;
  preferring.preferred = catalogued(*calibration.probe);
  const std::vector<std::string> candidates = candidates_for(table, fitted, flight, options);
  if (!options.only.empty() && candidates.empty()) {
    result.notes.push_back(fmt::format("the calibration has {} already; nothing else was asked",
                                       fmt::join(options.only, ", ")));
  }
  result.diagnosis = diagnose(fitted, candidates, preferring);
  for (const EffectFinding& effect : result.diagnosis.effects) {
    result.sentences.push_back(catalogue::describe_effect(table, effect.name));
  }
  std::size_t used = 0;
  for (const Segment& segment : fitted.rows) used += segment.rows();
  result.flight = {flight.name(), flight.sha256(), flight.rows(), used};
  result.missing_channels = catalogue::list_missing_channels(table, flight);
  result.where = measure_parts(fitted);
  return result;
}

/// Of a reading that never changes nothing can be learnt: whatever explains it is an artefact.
void refuse_frozen(const Calibration& calibration, const PreparedFlight& prepared) {
  const Probe& probe = *calibration.probe;
  const checks::TakenRows taken =
      checks::take_rows(probe, prepared.logged, calibration.options.log);
  std::vector<LogNote> found;
  checks::check_constants(checks::Log(probe, taken.flight), found);
  if (found.empty()) return;
  throw Error(
      fmt::format("{}; {}; {}", found.front().found, found.front().effect, found.front().advice));
}

/// The calibration of the rows that are readings; what was left out and mended is noted.
Calibration believe(const Calibration& calibration, PreparedFlight& prepared, const OwnEffects& own,
                    const DiagnosisOptions& options) {
  refuse_frozen(calibration, prepared);
  const RowsToLeave suspected = prepared.all;
  const std::vector<std::string> slow = prepared.slow;
  const auto left = without_suspects(calibration, prepared, own, options.progress);
  note_mended(prepared);
  if (!left) return calibration;
  prepared.readings.notes.push_back(
      say_left_out(prepared.logged.name(), left->options.log, suspected, slow));
  return *left;
}

/// Errors name the flight, as those of bringing it to the model do by themselves.
template <class Task>
FlightDiagnosis name_errors(const Flight& flight, Task task) {
  try {
    return task();
  } catch (const Error& error) {
    throw_within(flight.name() + ": ", error);
  }
}

/// What the effect adds to every output at the calibration's estimates.
MatrixXd added_outputs(const Calibration& calibration, const PreparedFlight& prepared,
                       const OwnEffects& own, const SizedEffect& injected, Injection& injection) {
  const Probe& probe = *calibration.probe;
  const EffectKit kit = effect_kit(probe, own);
  Record record = prepared.readings.record;
  std::vector<EffectSetting> settings = calibration.options.effects;
  settings.push_back({.name = injected.name});
  const std::vector<Effect> effects = make_effects(kit, *model_of(probe), settings, record);
  check_new(settings);
  injection.effect = settings.back().name;
  const auto model = compose(model_of(probe), effects, record);
  base::ThreadPool pool(calibration.options.fit.threads);
  return verbs::added_outputs({*model, record, calibration.fit.by_name(), shape_of(effects.back())},
                              injected, injection, pool);
}

}  // namespace

FlightDiagnosis diagnose(const Calibration& calibration, const Flight& flight,
                         const OwnEffects& own, const DiagnosisOptions& options) {
  PreparedFlight prepared = prepare(calibration, flight);
  return name_errors(flight, [&] {
    const OwnEffects all = all_own(calibration, own);
    const Calibration here = along(calibration, prepared);
    return run(believe(here, prepared, all, options), prepared, all, options);
  });
}

namespace {

FlightDiagnosis inject(const SizedEffect& injected, const Calibration& calibration,
                       PreparedFlight prepared, const OwnEffects& own,
                       const DiagnosisOptions& options) {
  const OwnEffects all = all_own(calibration, own);
  Injection injection;
  const MatrixXd added = added_outputs(calibration, prepared, all, injected, injection);
  const Record original = prepared.readings.record;
  prepared.readings.record =
      with_outputs(original, calibration.probe->model().tables().outputs, added);
  CalibrationOptions refit = calibration.options;
  refit.fit.start = calibration.fit.nonlinear_estimates();
  refit.fit.progress = options.progress;
  refit.own_effects = all;
  const Calibration again = calibrate(calibration.probe, prepared.readings.record, refit);
  FlightDiagnosis result = run(again, prepared, all, options);
  judge_injection(result.diagnosis, injection);
  result.injection = std::move(injection);
  return result;
}

}  // namespace

FlightDiagnosis diagnose_with(const SizedEffect& injected, const Calibration& calibration,
                              const Flight& flight, const OwnEffects& own,
                              const DiagnosisOptions& options) {
  PreparedFlight prepared = prepare(calibration, flight);
  return name_errors(flight, [&] {
    const Calibration here = along(calibration, prepared);
    const Calibration believed = believe(here, prepared, all_own(calibration, own), options);
    return inject(injected, believed, std::move(prepared), own, options);
  });
}

std::string describe(const UnmeasuredCause& cause) {
  const bool common = cause.kind == UnmeasuredKind::common_cause;
  std::string text = fmt::format("{}, not logged: in {}{}", common ? "common cause" : "line",
                                 fmt::join(cause.outputs, " and "), common ? " together" : "");
  text += cause.all_along ? ", all along"
                          : fmt::format(", strongest from {} to {} s", base::stamp(cause.first_s),
                                        base::stamp(cause.last_s));
  if (!std::isnan(cause.frequency)) text += fmt::format(", at {:.2g} Hz", cause.frequency);
  return text;
}

std::string with_unit(double value, const std::string& unit) {
  if (unit.empty()) return fmt::format("{:.3g} %", 100.0 * value);
  return fmt::format("{:.3g}{}", value, unit == "1" ? "" : " " + unit);
}

/// What is left over some outputs together, and what noise alone would leave.
struct ErrorLeft {
  double rmse = 0.0;
  double floor = 0.0;
  std::string unit = {};
  std::string of = {};  // " of Cm", of some outputs alone

  std::string in_words() const {
    if (unit.empty()) {  // in units of each output's own, what is left is all there is
      return fmt::format("noise alone would leave {} of the error{}", with_unit(floor, unit), of);
    }
    return fmt::format("{} of error are left{}; noise alone would leave {}", with_unit(rmse, unit),
                       of, with_unit(floor, unit));
  }
};

ErrorLeft error_of(const Diagnosis& found) { return {found.rmse, found.floor, found.unit}; }

ErrorLeft error_of(const Diagnosis& found, const std::vector<std::string>& outputs) {
  ErrorLeft left{.of = fmt::format(" in {}", fmt::join(outputs, ", "))};
  for (const std::string& name : outputs) {
    const auto own = std::ranges::find(found.residual, name, &ResidualNoise::output);
    left.rmse += own->rmse * own->rmse;
    left.floor += own->floor * own->floor;
    left.unit = own->unit;
  }
  const auto count = static_cast<double>(outputs.size());
  left.rmse = std::sqrt(left.rmse / count);
  left.floor = std::sqrt(left.floor / count);
  return left;
}

bool is_well_above_floor(const Diagnosis& found) {
  return found.rmse >= well_above_floor * found.floor;
}

/// Enough that "nothing" would be too much to say.
bool is_above_floor(const Diagnosis& found) {
  constexpr double above = 1.1;
  return found.rmse >= above * found.floor;
}

/// The flight that would tell an effect from noise.
std::string way_to_tell(const EffectFinding& effect) {
  if (effect.drivers.empty()) return "see whether it comes again in another flight";
  if (effect.drivers.front() == "time") return "fly again with the maneuvers in another order";
  return fmt::format("fly again with {} changing at other times", effect.drivers.front());
}

/// Of the mean square error what a noise model foretells from the rows before.
double correlated_share(const Diagnosis& found) {
  return 1.0 - std::pow(found.floor / found.rmse, 2);
}

/// Why what stands first is not advised; empty where nobody said.
std::string reason_against(const Diagnosis& found, const std::string& name) {
  for (const std::string& withheld : found.advice.withheld) {
    if (withheld.starts_with(name + ": ")) return withheld.substr(name.size() + 2);
  }
  return {};
}

/// As stepwise regression tells it.
std::string sentence_by_partial_f(const FlightDiagnosis& diagnosis) {
  if (diagnosis.diagnosis.effects.empty()) return "No candidate can be asked for its partial F.";
  const EffectFinding& first = diagnosis.diagnosis.effects.front();
  const Structure& structure = first.structure;
  if (first.status != FindingStatus::found) {
    return fmt::format(
        "No candidate enters: {} ({}) has the largest partial F, {:.4g} of at least {:.4g}.",
        first.name, diagnosis.sentences.front(), structure.partial_f, enters_from);
  }
  return fmt::format(
      "{} ({}) enters: partial F {:.4g} of at least {:.4g}, R^2 {:.4f} -> {:.4f}, residuals taken "
      "for white.",
      first.name, diagnosis.sentences.front(), structure.partial_f, enters_from,
      structure.r_squared_without, structure.r_squared);
}

/// Whether it is one time by which something is late.
bool is_lag(const EffectFinding& effect) {
  return effect.coefficients.size() == 1 && effect.coefficients.front().unit == "s" &&
         effect.shapes.empty();
}

/// "the inertial unit's time is late by 14 ms"
std::string lag_in_words(const EffectFinding& effect, std::string sentence) {
  constexpr double milliseconds = 1e3;
  constexpr std::string_view late = "late";
  const double lag = milliseconds * effect.coefficients.front().estimate;
  if (lag < 0.0 && sentence.ends_with(late)) {
    sentence.replace(sentence.size() - late.size(), late.size(), "early");
    return fmt::format("{} by {:.0f} ms", sentence, -lag);
  }
  return fmt::format("{} by {:.0f} ms", sentence, lag);
}

/// What stands first, and what it is. Lags that would do as well are one family: which of two
/// clocks is wrong is no matter of what they differ by.
std::string first_in_words(const FlightDiagnosis& diagnosis) {
  const std::vector<EffectFinding>& effects = diagnosis.diagnosis.effects;
  const EffectFinding& first = effects.front();
  std::vector<std::string> names{first.name};
  std::vector<std::string> words;
  for (std::size_t i = 1; i < effects.size(); ++i) {
    if (effects[i].beside != Beside::equivalent || !is_lag(first) || !is_lag(effects[i])) continue;
    names.push_back(effects[i].name);
    words.push_back(lag_in_words(effects[i], diagnosis.sentences[i]));
  }
  if (words.empty()) return fmt::format("{} ({})", first.name, diagnosis.sentences.front());
  words.insert(words.begin(), lag_in_words(first, diagnosis.sentences.front()));
  return fmt::format("{}, one lag that this flight can't place ({})", fmt::join(names, " or "),
                     fmt::join(words, ", or "));
}

std::string verdict_sentence(const FlightDiagnosis& diagnosis) {
  const Diagnosis& found = diagnosis.diagnosis;
  if (found.residual.empty()) return "Nothing is missing: the model leaves no error.";
  if (found.rule == DiagnosisRule::partial_f) return sentence_by_partial_f(diagnosis);
  const std::string injected =
      diagnosis.injection ? fmt::format("with {} injected, ", diagnosis.injection->effect) : "";
  const ErrorLeft all = error_of(found);
  const std::string left = injected + all.in_words();
  if (found.verdict == Verdict::unexplained && found.omnibus.significant) {
    return fmt::format(
        "Something is missing that no candidate explains: {}; it shows as offsets of {} from "
        "window to window (p = {:.1g}).",
        left, found.omnibus.where, found.omnibus.p_adjusted);
  }
  if (found.verdict == Verdict::unexplained && !found.unmeasured.empty()) {
    return fmt::format(
        "Something is missing that no candidate explains: {}; no channel of the log follows it "
        "(p = {:.1g}).",
        left, found.unmeasured.front().p_adjusted);
  }
  if (found.verdict == Verdict::unexplained) {
    const EffectFinding& first = found.effects.front();
    if (const std::string against = reason_against(found, first.name); !against.empty()) {
      return fmt::format("{} ({}) would take {:.0f} % of the error on rows held out, but {}: {}.",
                         first.name, diagnosis.sentences.front(), 100.0 * first.held_out_gain,
                         against, left);
    }
    return fmt::format(
        "{} ({}) would take {:.0f} % of the error on rows held out, and it is not certain: {}. "
        "Correlated noise could do the same: {}.",
        first.name, diagnosis.sentences.front(), 100.0 * first.held_out_gain, left,
        way_to_tell(first));
  }
  if (found.verdict == Verdict::adequate && diagnosis.status == FitStatus::not_identifiable) {
    return fmt::format(
        "This flight does not tell the model's own parameters, and shows nothing that is missing: "
        "{}.",
        left);
  }
  if (found.verdict == Verdict::adequate && !found.left_undone.empty()) {
    return fmt::format("Nothing was found in the time that there was, and not all was tried: {}.",
                       left);
  }
  if (found.verdict == Verdict::adequate && is_well_above_floor(found)) {
    return fmt::format(
        "No effect and no channel of the log explains what is left: {}. {:.0f} % of the error is "
        "correlated over about {:.2g} {}: noise can look like this, and so can a cause that is not "
        "in the log.",
        left, 100.0 * correlated_share(found), found.correlation_time,
        found.has_time ? "s" : "rows");
  }
  if (found.verdict == Verdict::adequate && is_above_floor(found)) {
    return fmt::format("No effect and no channel of the log explains the rest: {}.", left);
  }
  if (found.verdict == Verdict::adequate) {
    return fmt::format("Nothing is missing that this flight can show: {}.", left);
  }
  if (found.verdict == Verdict::slow_change) {
    const EffectFinding& slow = found.effects.front();
    return fmt::format(
        "A slow change fits {} ({}){}: {}. Noise that wanders does this too, and one flight can't "
        "tell: {}.",
        slow.name, diagnosis.sentences.front(),
        slow.held_out_gain > 0.0
            ? fmt::format(", which would take {:.0f} % of the error on rows held out",
                          100.0 * slow.held_out_gain)
            : "",
        left, way_to_tell(slow));
  }
  const EffectFinding& best = found.effects.front();
  const ErrorLeft of_best =
      best.outputs.size() < found.residual.size() ? error_of(found, best.outputs) : all;
  const std::string best_left = injected + of_best.in_words();
  if (found.advice.effect != best.name && !diagnosis.injection) {
    const std::string against = reason_against(found, best.name);
    return fmt::format(
        "{}: {}; one step promises {:.0f} % less on rows held out, but it is not to be added: {}.",
        first_in_words(diagnosis), best_left, 100.0 * best.held_out_gain,
        against.empty() ? "no fit with it was made" : against);
  }
  const std::string partner =
      found.advice.then.empty()
          ? ""
          : fmt::format(" and {}, sure together and not alone", found.advice.then);
  return fmt::format(
      "{}{}: {}; adding it should bring the error to {} ({:.0f} % less on rows held out, {:.0f} % "
      "on all).",
      first_in_words(diagnosis), partner, best_left,
      with_unit(of_best.rmse * (1.0 - best.predicted_drop), of_best.unit),
      100.0 * best.held_out_gain, 100.0 * best.predicted_drop);
}

}  // namespace sepcal
