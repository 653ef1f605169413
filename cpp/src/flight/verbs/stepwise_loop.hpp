// SPDX-License-Identifier: BSD-3-Clause
// The loop of a stepwise diagnosis, of sensors and of aircraft alike.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "sepcal/error.hpp"
#include "sepcal/flight/stepwise.hpp"

namespace sepcal::verbs {

/// RMSE over these outputs of a fit; those that it leaves no error of are zero.
double rmse_over(const Fit& fit, const std::vector<std::string>& outputs);

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
      step.rmse_before = rmse_over(fitted.fit, advised->outputs);
      step.rmse_after = rmse_over(next.fit, advised->outputs);
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
