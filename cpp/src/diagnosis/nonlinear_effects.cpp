// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/nonlinear_effects.hpp"

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

EffectFinding& finding_of(Findings& findings, const Alternative& alternative) {
  return *std::ranges::find(findings, alternative.candidate.name, &EffectFinding::name);
}

/// Schwarz's criterion of a fit to some rows, were the noise white; infinite where none comes of
/// it.
double criterion_of_some(const CandidateTesting& testing, const Alternative& alternative) {
  try {
    const Fit fit =
        refit_nearly(testing.room(), alternative.candidate, alternative.shape, rows_to_try);
    if (fit.status != FitStatus::converged) return infinity;
    double sum = 0.0;
    for (const OutputValue& rmse : fit.rmse) sum += std::log(rmse.value);
    const auto measurements = static_cast<Index>(fit.rows * fit.rmse.size());
    return 2.0 * static_cast<double>(fit.rows) * sum +
           schwarz_penalty(alternative.candidate, measurements);
  } catch (const Error&) {
    return infinity;
  }
}

/// How real fits without some rows predict them.
HeldOut hold_out_few(CandidateTesting& testing, const Alternative& alternative) {
  const CandidateRoom& room = testing.room();
  const Columns G = room.columns(alternative.candidate, alternative.shape).whole;
  return testing.refits().hold_out(alternative.candidate, alternative.shape,
                                   few_folds(room.fit(), G));
}

void tell_by_fit(const Alternative& alternative, const HeldOut& held_out,
                 const EffectFinding& surest, EffectFinding& finding) {
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
    const Parameter& fitted = alternative.fit[coefficient.name];
    coefficient.estimate = fitted.value;
    coefficient.standard_error = fitted.standard_error;
  }
  finding.predicted_drop = alternative.drop;
  for (auto& [name, shape] : finding.shapes) shape = alternative.fit[name].value;
}

}  // namespace

bool is_far_off(const CandidateTesting& testing, double floor) {
  const LinearisedFit& fit = testing.room().fit();
  return total_rmse(fit.layout, fit.residual) > far_off * floor;
}

std::vector<Alternative> try_on_some_rows(CandidateTesting& testing, const Findings& findings,
                                          const std::vector<Alternative>& known) {
  std::vector<Alternative> all;
  for (const EffectFinding& finding : findings) {
    const auto is_this = [&](const Alternative& one) { return one.candidate.name == finding.name; };
    if (finding.status == FindingStatus::cannot_be_seen || std::ranges::any_of(known, is_this)) {
      continue;
    }
    const Candidate& candidate = testing.room().make(finding.name);
    if (is_simple(candidate)) all.push_back({candidate, shape_of(finding)});
  }
  std::vector<std::pair<double, std::size_t>> criteria(all.size());
  testing.pool().for_each(
      all.size(), [&](std::size_t i) { criteria[i] = {criterion_of_some(testing, all[i]), i}; });
  testing.count({.tried_on_some_rows = all.size()});
  std::ranges::sort(criteria);
  std::vector<Alternative> best;
  for (const auto& [criterion, i] : criteria) {
    if (best.size() == most_tried || std::isinf(criterion)) break;
    best.push_back(std::move(all[i]));
  }
  return best;
}

void admit_nonlinear(CandidateTesting& testing, ModelSelection& selection, Findings& findings) {
  if (selection.alternatives.empty() ||
      !is_far_off(testing, testing.null().test->floor(selection.noise))) {
    return;
  }
  double likeliest = infinity;  // by Schwarz's criterion, of what was found
  double least_left = 1.0;      // of the error
  const EffectFinding* surest = nullptr;
  for (const Alternative& alternative : selection.alternatives) {
    const EffectFinding& finding = finding_of(findings, alternative);
    if (finding.status != FindingStatus::found) continue;
    likeliest = std::min(likeliest, alternative.criterion);
    least_left = std::min(least_left, error_left(alternative, finding));
    if (!surest || finding.log10_p < surest->log10_p) surest = &finding;
  }
  if (!surest) return;
  std::vector<Alternative> others = try_on_some_rows(testing, findings, selection.alternatives);
  fit_all(testing, selection.noise, others);
  std::ranges::move(others, std::back_inserter(selection.alternatives));
  for (const Alternative& alternative : selection.alternatives) {
    EffectFinding& finding = finding_of(findings, alternative);
    const bool takes_it = finding.status != FindingStatus::found &&
                          alternative.drop >= objects_from &&
                          alternative.fit.status == FitStatus::converged;
    const bool is_likelier = alternative.criterion < likeliest - as_likely;
    const double left_at_most = is_likelier ? 1.0 : clearly_less * least_left;
    if (!takes_it || !(1.0 - alternative.drop < left_at_most)) continue;
    const HeldOut held_out = hold_out_few(testing, alternative);
    if (held_out.judged && held_out.passed && 1.0 - held_out.gain < left_at_most) {
      tell_by_fit(alternative, held_out, *surest, finding);
    }
  }
}

}  // namespace sepcal::diagnosis
