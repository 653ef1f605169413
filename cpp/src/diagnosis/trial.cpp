// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/trial.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/refits.hpp"
#include "numerics/tails.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index most_thinned_rows = 3000;

MatrixXd thin_out(const MatrixXd& columns) {
  const Index stride = (columns.rows() + most_thinned_rows - 1) / most_thinned_rows;
  const Index rows = (columns.rows() + stride - 1) / stride;
  return columns(Eigen::seqN(0, rows, stride), Eigen::all);
}

/// The estimate of the effect from that of its basis.
void keep_estimate(const Projection& added, const VectorXd& of_basis, const MatrixXd& covariance,
                   Trial& trial) {
  trial.estimate = added.to_effect * of_basis;
  trial.covariance = added.to_effect * covariance * added.to_effect.transpose();
  trial.freedom = static_cast<int>(added.visible());
}

}  // namespace

Projection project_trial(const CandidateRoom& room, const NullHypothesis& null, const Trial& trial,
                         double shape) {
  return project(null.basis, room.columns(trial.candidate, shape),
                 room.varying_columns(trial.candidate, shape), trial.least_visibility);
}

double log10_scan(const Trial& trial) {
  return std::log10(static_cast<double>(trial.candidate.shape.values.size()));
}

void screen(const CandidateRoom& room, const NullHypothesis& null, Trial& trial) {
  const RowLayout& layout = room.fit().layout;
  double best_white = 1.0;  // log10 of the tail
  double best_plain = 1.0;
  for (const double shape : trial.candidate.shape.values) {
    const Projection added = project_trial(room, null, trial, shape);
    trial.visibility = std::max(trial.visibility, added.visibility);
    if (added.visible() == 0) continue;
    ShapeScore score{.shape = shape, .freedom = static_cast<int>(added.visible())};
    score.plain = (added.basis.transpose() * room.fit().residual).squaredNorm();
    MatrixXd white = added.basis;
    whiten(layout, null.best.noise, white);
    white = remove_span(null.white_basis, white);
    const MatrixXd covariance = pseudo_inverse(white.transpose() * white);
    const VectorXd product = white.transpose() * null.white_residual;
    const VectorXd step = covariance * product;
    score.white = product.dot(step);
    score.white = numerics::log10_chi_squared_tail(score.white, score.freedom);
    score.plain = numerics::log10_chi_squared_tail(score.plain, score.freedom);
    best_plain = std::min(best_plain, score.plain);
    trial.scores.push_back(score);
    if (!(score.white < best_white)) continue;
    best_white = score.white;
    trial.shape = shape;
    trial.thinned_basis = orthonormal_basis(thin_out(added.basis));
    keep_estimate(added, step, covariance, trial);
    trial.predicted_drop = predict_drop(null, added.basis);
  }
  trial.visible = !trial.scores.empty();
  if (!trial.visible) return;
  const double scans = log10_scan(trial);
  trial.log10_white = std::min(0.0, scans + best_white);
  trial.log10_plain = std::min(0.0, scans + best_plain);
  trial.log10_p = trial.log10_white;
}

void test(const CandidateRoom& room, const NullHypothesis& null, Trial& trial) {
  const RowLayout& layout = room.fit().layout;
  const auto by_white = std::ranges::min_element(trial.scores, {}, &ShapeScore::white);
  const auto by_plain = std::ranges::min_element(trial.scores, {}, &ShapeScore::plain);
  std::vector<double> shapes{by_white->shape};
  if (by_plain != by_white) shapes.push_back(by_plain->shape);
  trial.tested = true;
  trial.ratio = -1.0;
  for (const double shape : shapes) {
    const Projection added = project_trial(room, null, trial, shape);
    const LikelihoodRatio ratio = compare_with_null(null, added.basis);
    if (!(ratio.value > trial.ratio)) continue;
    trial.ratio = ratio.value;
    trial.noise = ratio.with.noise;
    trial.floor = noise_floor(layout, trial.noise);
    trial.shape = shape;
    const auto q = added.visible();
    keep_estimate(added, ratio.with.coefficients.tail(q),
                  ratio.with.covariance.bottomRightCorner(q, q), trial);
    trial.predicted_drop = predict_drop(null, added.basis);
    trial.thinned_basis = orthonormal_basis(thin_out(added.basis));
  }
  trial.log10_p = std::min(
      0.0, log10_scan(trial) + numerics::log10_chi_squared_tail(trial.ratio, trial.freedom));
}

bool is_smooth(const RowLayout& layout, const MatrixXd& columns) {
  constexpr double little = 0.25;  // of what two far apart differ by, squared
  const Index lag = std::max<Index>(1, layout.rows / 100);
  double changes = 0.0;
  double spread = 0.0;
  for (Index k = 0; k < columns.cols(); ++k) {
    for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
      const auto part = columns.col(k).segment(layout.first(j), layout.rows);
      const Index pairs = layout.rows - lag;
      changes += (part.tail(pairs) - part.head(pairs)).squaredNorm() / static_cast<double>(pairs);
      spread += 2.0 * (part.array() - part.mean()).square().mean();
    }
  }
  return changes < little * spread;
}

Inflation simulate_inflation(const CandidateRoom& room, const NullHypothesis& null,
                             const Trial& trial, int simulations, std::uint64_t seed,
                             base::ThreadPool& pool) {
  const Projection added = project_trial(room, null, trial, trial.shape);
  return inflation_of(simulate_ratios(null, added.basis, simulations, seed, pool), trial.freedom);
}

void inflate(const Inflation& inflation, Trial& trial) {
  const double calibrated =
      log10_scan(trial) + log10_ratio_tail(trial.ratio, trial.freedom, inflation);
  trial.log10_p = std::max(trial.log10_p, std::min(0.0, calibrated));
}

void hold_out(const CandidateRoom& room, const NullHypothesis& null, Trial& trial) {
  const Linearisation& fit = room.fit();
  const MatrixXd G = room.columns(trial.candidate, trial.shape);
  if (!is_smooth(fit.layout, G)) {
    trial.folds = whole_segments(fit.layout);
    judge_interpolated(fit.layout, G, trial.folds);
    if (trial.folds.count > 0) trial.held_out = hold_out(fit, G, trial.folds);
    if (trial.held_out.judged) return;
  }
  const VectorXd left = remove_span(project_trial(room, null, trial, trial.shape).basis,
                                    remove_span(null.basis, fit.residual));
  // A block left out must be short beside what the driver's functions vary over.
  int functions = 1;
  for (const Effect& effect : trial.candidate.effects) {
    if (effect.driver) functions = std::max(functions, effect.driver->functions());
  }
  trial.folds =
      interleaved_blocks(fit.layout, correlation_rows(fit.layout, left), 5 * (functions + 1));
  judge_interpolated(fit.layout, G, trial.folds);
  trial.held_out = hold_out(fit, G, trial.folds);
}

void confirm(const CandidateRoom& room, base::ThreadPool& pool, Trial& trial) {
  const HeldOut confirmed =
      hold_out_by_refits(room, trial.candidate, trial.shape, trial.folds, pool);
  if (confirmed.judged) trial.held_out = confirmed;
}

}  // namespace sepcal::diagnosis
