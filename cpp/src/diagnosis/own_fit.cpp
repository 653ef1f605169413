// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/own_fit.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "diagnosis/refits.hpp"
#include "sepcal/error.hpp"

namespace sepcal::diagnosis {
namespace {

constexpr std::size_t most_refitted = 6;  // of either screen
constexpr std::size_t most_judged = 3;
constexpr double worth_it = 0.01;  // of the error

DiagnosisOptions silently(DiagnosisOptions options) {
  options.progress = {};
  return options;
}

/// Whether nothing is scanned: a step's row alone is held where the fit begins.
bool is_at_one_shape(const Trial& trial) {
  return trial.candidate.shape.parameter.empty() || !trial.candidate.stepping_port.empty();
}

}  // namespace

OwnFit::OwnFit(const CandidateTesting& testing, const Candidate& candidate, double shape, Fit fit)
    : candidate_(candidate),
      shape_(shape),
      options_(silently(testing.options())),
      fitted_(with_candidate(testing.fitted(), candidate, std::move(fit))),
      testing_(fitted_, candidate_, options_, testing.pool()) {}

Trial OwnFit::test(double threshold) {
  Trials alone(1);
  alone.front().candidate = candidate_;
  if (!candidate_.shape.parameter.empty()) alone.front().candidate.shape.values = {shape_};
  testing_.screen_all(alone);
  if (!alone.front().visible) return std::move(alone.front());
  testing_.test_best(alone, 1, threshold, true);
  testing_.hold_out_significant(alone, true);
  testing_.calibrate_significant(alone, threshold, true);
  return std::move(alone.front());
}

std::vector<std::unique_ptr<OwnFit>> find_hidden(const CandidateTesting& testing,
                                                 const Trials& trials) {
  struct Fitted {
    const Trial* trial;
    Fit fit = {};
    double drop = -infinity;
  };
  std::vector<Fitted> fits;
  const auto can_hide = [](const Trial& trial) { return trial.visible && is_at_one_shape(trial); };
  for (const std::size_t i : best_of(trials, most_refitted, can_hide)) fits.push_back({&trials[i]});
  testing.pool().for_each(fits.size(), [&](std::size_t i) {
    auto& [trial, fit, drop] = fits[i];
    try {
      fit = testing.refits().with(trial->candidate, trial->shape);
    } catch (const Error&) {
      return;
    }
    if (fit.status == FitStatus::converged) drop = error_drop(testing.room().fitted(), fit);
  });
  std::erase_if(fits, [](const Fitted& fitted) { return !(fitted.drop > worth_it); });
  std::ranges::stable_sort(fits, std::ranges::greater(), &Fitted::drop);
  if (fits.size() > most_judged) fits.resize(most_judged);
  std::vector<std::unique_ptr<OwnFit>> hidden;
  for (Fitted& fitted : fits) {
    hidden.push_back(std::make_unique<OwnFit>(testing, fitted.trial->candidate, fitted.trial->shape,
                                              std::move(fitted.fit)));
  }
  return hidden;
}

}  // namespace sepcal::diagnosis
