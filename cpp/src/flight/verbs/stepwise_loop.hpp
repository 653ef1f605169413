// SPDX-License-Identifier: BSD-3-Clause
// The loop of a stepwise diagnosis, of sensors and of aircraft alike.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "sepcal/error.hpp"
#include "sepcal/flight/stepwise.hpp"

namespace sepcal::verbs {

/// Keeps the RMSE over the step's outputs of the fits before and after it; where these have
/// different units in units of each one's own before.
void measure_step(const Fit& before, const Fit& after, bool one_unit, StepwiseStep& step);

/// Throws OptionError where there is nothing to add.
void check_most(const StepwiseOptions& options);

/// Why a fit with one effect more is no step; empty where it is one.
std::string objection_to_step(const Fit& before, const Fit& after, const StepwiseStep& step);

/// The options of a diagnosis of one candidate among so many; as they are where it is empty.
DiagnosisOptions about(DiagnosisOptions options, const std::string& only, std::size_t among);

/// The steps' table as to_json() has it.
void finish(Stepwise& course, StepwiseEnd end, std::string reason);

/// What is to be added next, or nullptr, why being told in `course`.
const EffectFinding* next_effect(Stepwise& course, std::size_t most);

/// What would do as well as what is advised: of the first alone it was asked.
std::vector<std::string> list_as_good(const Diagnosis& found);

/// Whether the one effect that was asked about is found, or takes what matters on rows held out,
/// however sure that is: without it the model would be worse.
bool still_counts(const Diagnosis& of_one);

/// What the steps added and none dropped, in that order.
std::vector<std::string> list_kept(const Stepwise& course);

/// `Fitted` has a member `fit`. `diagnose(fitted, only, among)`, of everything or as about() has
/// it, and `add(fitted, effect)` are the verbs; what add throws ends the loop.
template <class Fitted>
struct StepwiseLoop {
  Fitted base;
  std::size_t most = 0;
  std::function<FlightDiagnosis(const Fitted&, const std::string& only, std::size_t among)>
      diagnose;
  std::function<Fitted(const Fitted&, const std::string&)> add;

  /// The base with these effects, added in turn.
  Fitted with(const std::vector<std::string>& effects) const {
    Fitted fitted = base;
    for (const std::string& effect : effects) fitted = add(fitted, effect);
    return fitted;
  }

  /// Asks of each effect that was added before the last whether it is found beside all others, and
  /// drops those that are not: they stood in for what came later.
  void drop_what_fades(Stepwise& course, Fitted& fitted) const {
    const std::vector<std::string> before = list_kept(course);
    const std::size_t among = course.last.diagnosis.effects.size();
    for (const std::string& asked : before) {
      if (asked == before.back()) continue;
      std::vector<std::string> others = list_kept(course);
      std::erase(others, asked);
      try {
        Fitted without = with(others);
        if (still_counts(diagnose(without, asked, among).diagnosis)) continue;
        course.steps.back().dropped.push_back(asked);
        fitted = std::move(without);
      } catch (const Error&) {
        continue;  // there is no fit without it
      }
    }
  }

  /// Adds the effect that is promised and fits anew. Returns why that is no step; empty where it
  /// is.
  std::string take(Stepwise& course, Fitted& fitted, StepwiseStep step) const {
    const std::string effect = step.promised.name;
    try {
      Fitted next = add(fitted, effect);
      measure_step(fitted.fit, next.fit, !course.last.diagnosis.unit.empty(), step);
      std::string objection = objection_to_step(fitted.fit, next.fit, step);
      if (!objection.empty()) return objection;
      fitted = std::move(next);
    } catch (const Error& error) {
      return effect + " can't be added: " + error.what();
    }
    course.steps.push_back(std::move(step));
    return {};
  }

  /// The partner of what was added last: found with it, and not asked whether it is sure alone.
  void take_partner(Stepwise& course, Fitted& fitted, const std::string& partner) const {
    if (partner.empty() || course.steps.size() >= most) return;
    const std::size_t among = course.last.diagnosis.effects.size();
    const Diagnosis asked = diagnose(fitted, partner, among).diagnosis;
    if (asked.effects.empty()) return;
    const EffectFinding& promised = asked.effects.front();
    if (promised.structure.partial_f >= enters_from) take(course, fitted, {.promised = promised});
  }

  /// Where it ends, in `fitted` too.
  Stepwise run(Fitted& fitted) const {
    Stepwise course;
    fitted = base;
    course.last = diagnose(fitted, "", 0);
    while (const EffectFinding* const advised = next_effect(course, most)) {
      const std::string objection = take(
          course, fitted, {.promised = *advised, .as_good = list_as_good(course.last.diagnosis)});
      if (!objection.empty()) {
        finish(course, StepwiseEnd::fit_failed, objection);
        return course;
      }
      take_partner(course, fitted, course.last.diagnosis.advice.then);
      drop_what_fades(course, fitted);
      course.last = diagnose(fitted, "", 0);
    }
    return course;
  }
};

}  // namespace sepcal::verbs
