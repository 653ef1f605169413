// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/stepwise.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "flight/verbs/prepared_flight.hpp"
#include "flight/verbs/stepwise_loop.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

void verbs::measure_step(const Fit& before, const Fit& after, bool one_unit, StepwiseStep& step) {
  double square_before = 0.0;
  double square_after = 0.0;
  for (std::size_t j = 0; j < before.rmse.size(); ++j) {
    const std::vector<std::string>& outputs = step.promised.outputs;
    if (std::ranges::find(outputs, before.rmse[j].name) == outputs.end()) continue;
    const double unit = one_unit ? 1.0 : before.rmse[j].value;
    square_before += std::pow(before.rmse[j].value / unit, 2);
    square_after += std::pow(after.rmse[j].value / unit, 2);
  }
  const auto count = static_cast<double>(step.promised.outputs.size());
  step.rmse_before = std::sqrt(square_before / count);
  step.rmse_after = std::sqrt(square_after / count);
}

void verbs::check_most(const StepwiseOptions& options) {
  if (options.most > 0) return;
  throw OptionError({Option{"most"}, " 0 lets nothing be added; give at least 1, or leave ",
                     Option{"auto"}, " out to be told alone what is missing"});
}

std::string verbs::objection_to_step(const Fit& before, const Fit& after,
                                     const StepwiseStep& step) {
  const std::string& effect = step.promised.name;
  if (after.status != FitStatus::converged && after.status != before.status) {
    return fmt::format(
        "the fit with {} is {}: {}", effect,
        after.status == FitStatus::not_converged ? "not converged" : "not identifiable",
        after.message);
  }
  if (step.rmse_after < step.rmse_before) return {};
  return fmt::format("fitted with {} the error did not fall ({:.4g} -> {:.4g})", effect,
                     step.rmse_before, step.rmse_after);
}

DiagnosisOptions verbs::about(DiagnosisOptions options, const std::string& only,
                              std::size_t among) {
  if (only.empty()) return options;
  options.only = {only};
  options.others = among > 1 ? among - 1 : 0;
  return options;
}

void verbs::finish(Stepwise& course, StepwiseEnd end, std::string reason) {
  course.end = end;
  course.reason = std::move(reason);
}

std::vector<std::string> verbs::list_as_good(const Diagnosis& found) {
  if (found.effects.front().name != found.advice.effect) return {};
  return list_beside(found, Beside::equivalent);
}

bool verbs::still_counts(const Diagnosis& of_one) {
  constexpr double matters = 0.1;
  if (of_one.verdict == Verdict::effect_missing) return true;
  return std::ranges::any_of(of_one.effects, [](const EffectFinding& effect) {
    return effect.held_out_passed && effect.held_out_gain >= matters;
  });
}

std::vector<std::string> verbs::list_kept(const Stepwise& course) {
  std::vector<std::string> kept;
  for (const StepwiseStep& step : course.steps) {
    for (const std::string& name : step.dropped) std::erase(kept, name);
    kept.push_back(step.promised.name);
  }
  return kept;
}

const EffectFinding* verbs::next_effect(Stepwise& course, std::size_t most) {
  const Diagnosis& found = course.last.diagnosis;
  const std::string& advised = found.advice.effect;
  for (const StepwiseStep& step : course.steps) {
    if (advised.empty() || std::ranges::find(step.dropped, advised) == step.dropped.end()) continue;
    finish(
        course, StepwiseEnd::withheld,
        fmt::format("{} would come back, which {} took the place of", advised, step.promised.name));
    return nullptr;
  }
  if (found.verdict == Verdict::effect_missing && !advised.empty() && course.steps.size() < most) {
    return &*std::ranges::find(found.effects, advised, &EffectFinding::name);
  }
  if (advised.empty() && !found.advice.withheld.empty()) {
    finish(
        course, StepwiseEnd::withheld,
        fmt::format("what passes is not to be added: {}", fmt::join(found.advice.withheld, "; ")));
  } else if (found.verdict == Verdict::effect_missing) {
    finish(course, StepwiseEnd::most_added,
           fmt::format("the most that were asked for, {}, are added; {} would be next", most,
                       advised));
  } else {
    finish(course, StepwiseEnd::nothing_found,
           found.verdict == Verdict::adequate ? "nothing more passes"
           : found.verdict == Verdict::slow_change
               ? "nothing more passes; a slow change is left, or noise that wanders"
               : "nothing more passes, though something is left that no candidate explains");
  }
  return nullptr;
}

StepwiseCalibration diagnose_stepwise(const Calibration& base, const Flight& flight,
                                      const OwnEffects& own, const StepwiseOptions& options) {
  check_most(options);
  const FitProgress& progress = options.diagnosis.progress;
  PreparedFlight prepared = prepare(base, flight);
  OnFlight here = on_readings_of(along(base, prepared), flight, prepared, own, progress);
  Calibration calibration = std::move(here.calibration);
  calibration.notes = std::move(here.notes);
  const StepwiseLoop<Calibration> loop{
      calibration, options.most,
      [&](const Calibration& at, const std::string& only, std::size_t among) {
        return diagnose(at, flight, own, about(options.diagnosis, only, among));
      },
      [&](const Calibration& at, const std::string& effect) {
        return add_effect(at, flight, effect, own, progress);
      }};
  Stepwise course = loop.run(calibration);
  calibration.probe->judge_flights(calibration, flight);
  return {std::move(calibration), std::move(course)};
}

}  // namespace sepcal
