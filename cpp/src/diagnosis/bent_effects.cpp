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

/// How real fits without some rows predict them.
HeldOut hold_out_few(Bench& bench, const Contender& contender) {
  const CandidateRoom& room = bench.room();
  const Columns G = room.columns(contender.candidate, contender.shape).whole;
  return bench.refits().hold_out(contender.candidate, contender.shape, few_folds(room.fit(), G));
}

void tell_by_fit(const Contender& contender, const HeldOut& held_out, const EffectFinding& surest,
                 EffectFinding& finding) {
  finding.held_out_before = held_out.before;
  finding.held_out_after = held_out.after;
  finding.held_out_gain = held_out.gain;
  finding.held_out_passed = true;
  finding.held_out_interleaved = true;
  finding.held_out_refitted = true;
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
  finding.predicted_drop = contender.drop;
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
  if (contest.contenders.empty() || !is_far_off(bench, bench.null().test->floor(contest.noise))) {
    return;
  }
  double likeliest = infinity;  // by Schwarz's criterion, of what was found
  double least_left = 1.0;      // of the error
  const EffectFinding* surest = nullptr;
  for (const Contender& contender : contest.contenders) {
    const EffectFinding& finding = finding_of(findings, contender);
    if (finding.status != FindingStatus::found) continue;
    likeliest = std::min(likeliest, contender.criterion);
    least_left = std::min(least_left, error_left(contender, finding));
    if (!surest || finding.log10_p < surest->log10_p) surest = &finding;
  }
  if (!surest) return;
  std::vector<Contender> others = try_on_some_rows(bench, findings, contest.contenders);
  fit_all(bench, contest.noise, others);
  std::ranges::move(others, std::back_inserter(contest.contenders));
  for (const Contender& contender : contest.contenders) {
    EffectFinding& finding = finding_of(findings, contender);
    const bool takes_it = finding.status != FindingStatus::found &&
                          contender.drop >= objects_from &&
                          contender.fit.status == FitStatus::converged;
    const bool is_likelier = contender.criterion < likeliest - as_likely;
    const double left_at_most = is_likelier ? 1.0 : clearly_less * least_left;
    if (!takes_it || !(1.0 - contender.drop < left_at_most)) continue;
    const HeldOut held_out = hold_out_few(bench, contender);
    if (held_out.judged && held_out.passed && 1.0 - held_out.gain < left_at_most) {
      tell_by_fit(contender, held_out, *surest, finding);
    }
  }
}

}  // namespace sepcal::diagnosis
