// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/bent_effects.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "diagnosis/held_out.hpp"
#include "diagnosis/refits.hpp"
#include "sepcal/error.hpp"

namespace sepcal::diagnosis {
namespace {

constexpr double far_off = 3.0;           // the RMSE over what noise leaves
constexpr std::size_t rows_to_try = 400;  // of a first fit
constexpr std::size_t most_tried = 4;

using Eigen::Index;
using Findings = std::vector<EffectFinding>;

EffectFinding& finding_of(Findings& findings, const Contender& contender) {
  return *std::ranges::find(findings, contender.candidate.name, &EffectFinding::name);
}

/// Schwarz's criterion of a fit to some rows, were the noise white; infinite where none comes of
/// it.
double criterion_of_some(const Bench& bench, const Contender& contender) {
  try {
    const Fit fit = refit_nearly(bench.room(), contender.candidate, contender.shape, rows_to_try);
    if (fit.status != FitStatus::converged) return infinity;
    double sum = 0.0;
    for (const OutputValue& rmse : fit.rmse) sum += std::log(rmse.value);
    const auto measurements = static_cast<Index>(fit.rows * fit.rmse.size());
    return 2.0 * static_cast<double>(fit.rows) * sum +
           schwarz_penalty(contender.candidate, measurements);
  } catch (const Error&) {
    return infinity;
  }
}

/// Whether real fits without some rows predict them better; the finding is told so.
bool predicts(Bench& bench, const Contender& contender, EffectFinding& finding) {
  const CandidateRoom& room = bench.room();
  const Columns G = room.columns(contender.candidate, contender.shape).whole;
  const HeldOut held_out =
      bench.refits().hold_out(contender.candidate, contender.shape, few_folds(room.fit(), G));
  if (!held_out.judged || !held_out.passed) return false;
  finding.held_out_before = held_out.before;
  finding.held_out_after = held_out.after;
  finding.held_out_gain = held_out.gain;
  finding.held_out_passed = true;
  finding.held_out_interleaved = true;
  finding.held_out_refitted = true;
  return true;
}

/// What a fit with it takes of the RMSE over all outputs.
double drop_of(const Contender& contender, double rmse_before) {
  double squares = 0.0;
  for (const OutputValue& rmse : contender.fit.rmse) squares += rmse.value * rmse.value;
  const auto outputs = static_cast<double>(contender.fit.rmse.size());
  return 1.0 - std::sqrt(squares / outputs) / rmse_before;
}

void tell_by_fit(const Contender& contender, double rmse_before, const EffectFinding& surest,
                 EffectFinding& finding) {
  finding.status = FindingStatus::found;
  finding.log10_p = surest.log10_p;
  finding.p_value = surest.p_value;
  finding.p_adjusted = surest.p_adjusted;
  finding.p_listed = surest.p_listed;
  for (Coefficient& coefficient : finding.coefficients) {
    const Parameter& fitted = contender.fit[coefficient.name];
    coefficient.estimate = fitted.value;
    coefficient.standard_error = fitted.standard_error;
  }
  finding.predicted_drop = drop_of(contender, rmse_before);
  for (auto& [name, shape] : finding.shapes) shape = contender.fit[name].value;
}

}  // namespace

bool is_far_off(const Bench& bench, double floor) {
  const LinearisedFit& fit = bench.room().fit();
  return total_rmse(fit.layout, fit.residual) > far_off * floor;
}

std::vector<Contender> try_on_some_rows(Bench& bench, const Findings& findings,
                                        const std::vector<Contender>& known) {
  std::vector<Contender> all;
  for (const EffectFinding& finding : findings) {
    const auto is_this = [&](const Contender& one) { return one.candidate.name == finding.name; };
    if (finding.status == FindingStatus::cannot_be_seen || std::ranges::any_of(known, is_this)) {
      continue;
    }
    const Candidate& candidate = bench.room().make(finding.name);
    if (is_simple(candidate)) all.push_back({candidate, shape_of(finding)});
  }
  std::vector<std::pair<double, std::size_t>> criteria(all.size());
  bench.pool().for_each(
      all.size(), [&](std::size_t i) { criteria[i] = {criterion_of_some(bench, all[i]), i}; });
  bench.count({.tried_on_some_rows = all.size()});
  std::ranges::sort(criteria);
  std::vector<Contender> best;
  for (const auto& [criterion, i] : criteria) {
    if (best.size() == most_tried || std::isinf(criterion)) break;
    best.push_back(std::move(all[i]));
  }
  return best;
}

void admit_bent(Bench& bench, Contest& contest, Findings& findings) {
  const CandidateRoom& room = bench.room();
  const double rmse = total_rmse(room.fit().layout, room.fit().residual);
  if (contest.contenders.empty() || !is_far_off(bench, bench.null().test->floor(contest.noise))) {
    return;
  }
  double least = infinity;
  const EffectFinding* surest = nullptr;
  for (const Contender& contender : contest.contenders) {
    const EffectFinding& finding = finding_of(findings, contender);
    if (finding.status != FindingStatus::found) continue;
    least = std::min(least, contender.criterion);
    if (!surest || finding.log10_p < surest->log10_p) surest = &finding;
  }
  if (!surest) return;
  std::vector<Contender> others = try_on_some_rows(bench, findings, contest.contenders);
  fit_all(bench, contest.noise, others);
  std::ranges::move(others, std::back_inserter(contest.contenders));
  for (const Contender& contender : contest.contenders) {
    EffectFinding& finding = finding_of(findings, contender);
    const bool is_better =
        finding.status != FindingStatus::found && contender.criterion < least - as_likely &&
        drop_of(contender, rmse) >= objects_from && contender.fit.status == FitStatus::converged;
    if (is_better && predicts(bench, contender, finding)) {
      tell_by_fit(contender, rmse, *surest, finding);
    }
  }
}

}  // namespace sepcal::diagnosis
