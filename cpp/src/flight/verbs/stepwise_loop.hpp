// SPDX-License-Identifier: BSD-3-Clause
// The loop of a stepwise diagnosis, of sensors and of aircraft alike.
#pragma once

#include <functional>
#include <string>
#include <utility>

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

/// The steps' table as to_json() has it.
void finish(Stepwise& course, StepwiseEnd end, std::string reason);

/// What is to be added next, or nullptr, why being told in `course`.
const EffectFinding* next_effect(Stepwise& course, std::size_t most);

/// `Fitted` has a member `fit`. `diagnose(fitted)` and `add(fitted, effect)` are the verbs; what
/// add throws ends the loop.
template <class Fitted>
Stepwise run_stepwise(Fitted& fitted, std::size_t most,
                      const std::function<FlightDiagnosis(const Fitted&)>& diagnose,
                      const std::function<Fitted(const Fitted&, const std::string&)>& add) {
  Stepwise course;
  course.last = diagnose(fitted);
  while (const EffectFinding* const advised = next_effect(course, most)) {
    StepwiseStep step{.promised = *advised};
    try {
      Fitted next = add(fitted, advised->name);
      measure_step(fitted.fit, next.fit, !course.last.diagnosis.unit.empty(), step);
      const std::string objection = objection_to_step(fitted.fit, next.fit, step);
      if (!objection.empty()) {
        finish(course, StepwiseEnd::fit_failed, objection);
        return course;
      }
      fitted = std::move(next);
    } catch (const Error& error) {
      finish(course, StepwiseEnd::fit_failed, advised->name + " can't be added: " + error.what());
      return course;
    }
    course.steps.push_back(std::move(step));
    course.last = diagnose(fitted);
  }
  return course;
}

}  // namespace sepcal::verbs
