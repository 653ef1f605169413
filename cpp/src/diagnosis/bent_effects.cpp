// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/bent_effects.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/held_out.hpp"
#include "diagnosis/refits.hpp"
#include "sepcal/error.hpp"

namespace sepcal::diagnosis {
namespace {

constexpr double far_off = 2.0;            // the RMSE over what noise leaves
constexpr std::size_t rows_to_try = 2000;  // of a first fit

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

/// Those whose fits to some rows are better than any of the contest's.
std::vector<Contender> find_better(Bench& bench, const Contest& contest, const Findings& findings) {
  std::vector<Contender> all = contest.contenders;
  for (const EffectFinding& finding : findings) {
    const auto known = [&](const Contender& one) { return one.candidate.name == finding.name; };
    if (finding.status == FindingStatus::cannot_be_seen || split_effects(finding.name).size() > 1 ||
        std::ranges::any_of(contest.contenders, known)) {
      continue;
    }
    all.push_back({bench.room().make(finding.name), shape_of(finding)});
  }
  std::vector<double> criteria(all.size());
  bench.pool().for_each(all.size(),
                        [&](std::size_t i) { criteria[i] = criterion_of_some(bench, all[i]); });
  const auto known = static_cast<std::ptrdiff_t>(contest.contenders.size());
  const double least = *std::min_element(criteria.begin(), criteria.begin() + known);
  std::vector<Contender> better;
  for (std::size_t i = contest.contenders.size(); i < all.size(); ++i) {
    if (criteria[i] < least) better.push_back(std::move(all[i]));
  }
  return better;
}

/// Whether real fits without some rows predict them better; the finding is told so.
bool predicts(Bench& bench, const Contender& contender, EffectFinding& finding) {
  const CandidateRoom& room = bench.room();
  const Columns G = room.columns(contender.candidate, contender.shape).whole;
  const HeldOut held_out = hold_out_by_refits(room, contender.candidate, contender.shape,
                                              few_folds(room.fit(), G), bench.pool());
  if (!held_out.judged || !held_out.passed) return false;
  finding.held_out_before = held_out.before;
  finding.held_out_after = held_out.after;
  finding.held_out_gain = held_out.gain;
  finding.held_out_passed = true;
  finding.held_out_interleaved = true;
  return true;
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
  double squares = 0.0;
  for (const OutputValue& rmse : contender.fit.rmse) squares += rmse.value * rmse.value;
  const auto outputs = static_cast<double>(contender.fit.rmse.size());
  finding.predicted_drop = 1.0 - std::sqrt(squares / outputs) / rmse_before;
  for (auto& [name, shape] : finding.shapes) shape = contender.fit[name].value;
}

}  // namespace

void admit_bent(Bench& bench, Contest& contest, Findings& findings) {
  const CandidateRoom& room = bench.room();
  const double rmse = total_rmse(room.fit().layout, room.fit().residual);
  if (contest.contenders.empty() || rmse < far_off * bench.null().test->floor(contest.noise)) {
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
  std::vector<Contender> better = find_better(bench, contest, findings);
  fit_all(bench, contest.noise, better);
  for (Contender& contender : better) {
    EffectFinding& finding = finding_of(findings, contender);
    if (!(contender.criterion < least - as_likely)) continue;
    if (contender.fit.status != FitStatus::converged || !predicts(bench, contender, finding)) {
      continue;
    }
    tell_by_fit(contender, rmse, *surest, finding);
    contest.contenders.push_back(std::move(contender));
  }
}

}  // namespace sepcal::diagnosis
