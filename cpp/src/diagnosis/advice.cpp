// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/advice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sepcal/error.hpp"

namespace sepcal::diagnosis {
namespace {

/// The parameters that the fit has at a bound and the one before had not, with their bounds.
std::vector<std::string> newly_at_bounds(const Fit& before, const Fit& after) {
  std::vector<std::string> names;
  for (const Parameter& parameter : after.parameters) {
    if (!parameter.at_bound) continue;
    const auto old = std::ranges::find(before.parameters, parameter.name, &Parameter::name);
    if (old != before.parameters.end() && old->at_bound) continue;
    names.push_back(
        fmt::format("{} [{:.4g}, {:.4g}]", parameter.name, parameter.lower, parameter.upper));
  }
  return names;
}

/// The coefficient whose fitted value is least like the step's, where it is of another sign or
/// several times as large and noise does not explain it.
std::string disagreement(const EffectFinding& finding, const Fit& fitted) {
  constexpr double errors = 4.0;
  constexpr double times = 3.0;
  constexpr double small = 0.1;  // of the largest of its unit: its sign says nothing of the effect
  const auto size_of = [&](const Coefficient& coefficient) {
    return std::max(std::abs(coefficient.estimate), std::abs(fitted[coefficient.name].value));
  };
  for (const Coefficient& coefficient : finding.coefficients) {
    const bool is_small = std::ranges::any_of(finding.coefficients, [&](const Coefficient& other) {
      return other.unit == coefficient.unit && size_of(coefficient) < small * size_of(other);
    });
    if (is_small) continue;
    const Parameter& now = fitted[coefficient.name];
    const double error = std::max(coefficient.standard_error, now.standard_error);
    const double change = std::abs(now.value - coefficient.estimate);
    const bool alike = now.value * coefficient.estimate > 0.0 &&
                       std::abs(now.value) < times * std::abs(coefficient.estimate) &&
                       std::abs(coefficient.estimate) < times * std::abs(now.value);
    if (alike || !(change > errors * error)) continue;
    return fmt::format("fitted, {} is {:.3g}, where one step from here has {:.3g}",
                       coefficient.name, now.value, coefficient.estimate);
  }
  return {};
}

/// What is wrong with the fit that has the effect, if anything. One that takes as much of the error
/// as the step promised is believed before it.
void object_to_fit(const Fit& before, const EffectFinding& finding, const Fit& fitted,
                   bool keeps_promise, Objection& objection) {
  if (fitted.status != FitStatus::converged) {
    objection.reason = fmt::format("a fit with it is {}", fitted.status == FitStatus::not_converged
                                                              ? "not converged"
                                                              : "not identifiable");
  } else if (const auto held = newly_at_bounds(before, fitted); !held.empty()) {
    objection.is_of_bounds = true;
    objection.reason = fmt::format(
        "fitted, it runs into the bounds of {}; give wider ones to the fit", fmt::join(held, ", "));
  } else if (!keeps_promise) {
    objection.reason = disagreement(finding, fitted);
  }
  objection.is_to_fit = !objection.reason.empty();
}

/// A lag that a fit finds no longer than its error, which allows for colour, is none, whatever one
/// step from the fit without it said.
std::string lag_within_error(const CandidateRoom& room, const Candidate& candidate, double shape) {
  constexpr double errors = 2.0;
  constexpr double milliseconds = 1e3;
  if (!room.follows_path() || !is_lag(candidate)) return {};
  const Fit fitted = refit_nearly(room, candidate, shape, enough_rows, true);
  const Parameter& lag = fitted[candidate.coefficients.front().name];
  if (!(std::abs(lag.value) <= errors * lag.standard_error)) return {};
  return fmt::format("fitted, {} is {:.1f} +- {:.1f} ms, no more than its error", lag.name,
                     milliseconds * lag.value, milliseconds * lag.standard_error);
}

/// The coefficient that a fit has further off than physics lets it be.
std::string implausible_size(const CandidateRoom& room, const Candidate& candidate,
                             const Fit& fitted) {
  constexpr double errors = 2.0;
  std::size_t at = 0;
  for (std::size_t i = 0; i < candidate.effects.size(); ++i) {
    for (std::size_t k = 0; k < candidate.counts[i]; ++k, ++at) {
      const Variable& coefficient = candidate.coefficients[at];
      const Interval range = plausible_range(candidate.effects[i], coefficient, room.record());
      const Parameter& now = fitted[coefficient.name];
      const double error = std::isfinite(now.standard_error) ? errors * now.standard_error : 0.0;
      if (now.value + error < range.lower || now.value - error > range.upper) {
        return fmt::format(
            "fitted, {} is {:.3g} +- {:.1g}, and physics lets it be {:.3g} to {:.3g}",
            coefficient.name, now.value, now.standard_error, range.lower, range.upper);
      }
    }
  }
  return {};
}

}  // namespace

Objection find_objection(CandidateRoom& room, Refits& refits, const EffectFinding& finding,
                         double least_visibility) {
  constexpr double nearly_all = 0.9;  // rows held out take no part in the fit
  Objection objection;
  if (!(finding.visibility >= room.visible_from(least_visibility))) {
    objection.reason = fmt::format(
        "the flight hardly tells it from the model's own parameters (visibility {:.2f})",
        finding.visibility);
    if (!room.follows_path()) return objection;
  }
  const Candidate candidate = room.make(finding.name);
  const double shape = shape_of(finding);
  try {
    const Fit& fitted = refits.with(candidate, shape);
    if (room.follows_path()) objection.drop = drop_of_adding(room, candidate, fitted);
    if (!objection.reason.empty()) return objection;
    const bool keeps_promise =
        room.follows_path() ? objection.drop >= finding.predicted_drop
                            : finding.held_out_refitted && finding.held_out_passed &&
                                  finding.held_out_gain >=
                                      std::max(objects_from, nearly_all * finding.predicted_drop);
    object_to_fit(room.fitted(), finding, fitted, keeps_promise, objection);
    if (objection.is_to_fit) return objection;
    objection.reason = lag_within_error(room, candidate, shape);
    if (!objection.reason.empty()) return objection;
    objection.reason = implausible_size(room, candidate, fitted);
    if (!objection.reason.empty()) return objection;
    const Folds folds = few_folds(room.fit(), room.columns(candidate, shape).whole);
    const HeldOut held_out = refits.hold_out(candidate, shape, folds);
    if (held_out.judged && !(held_out.gain > 0.0)) {
      objection.reason =
          fmt::format("real fits without some rows predict them no better ({:.1f} % more error)",
                      -100.0 * held_out.gain);
    }
  } catch (const Error& error) {
    objection.is_to_fit = true;
    objection.reason = std::string("it can't be fitted here: ") + error.what();
  }
  return objection;
}

}  // namespace sepcal::diagnosis
