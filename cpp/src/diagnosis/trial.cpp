// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/trial.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/block_jackknife.hpp"
#include "numerics/tails.hpp"
#include "numerics/tall_products.hpp"
#include "sepcal/detail/triangular_factor.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// What a step from each row on explains of the residual, as if that were white (N; the first row
/// is none): with suffix sums in one pass.
VectorXd explained_by_steps(const NullHypothesis& null, const MatrixXd& port) {
  const RowLayout& layout = null.fit().layout;
  const MatrixXd& tangent = null.fit().tangent;
  const Index c = port.cols();
  MatrixXd squares = MatrixXd::Zero(c, c);
  MatrixXd products_with_tangent = MatrixXd::Zero(tangent.cols(), c);
  VectorXd products = VectorXd::Zero(c);
  VectorXd explained = VectorXd::Zero(layout.rows);
  for (Index row = layout.rows - 1; row > 0; --row) {
    for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
      const Index at = layout.first(j) + row;
      squares += port.row(at).transpose() * port.row(at);
      products_with_tangent += tangent.row(at).transpose() * port.row(at);
      products += port.row(at).transpose() * null.residual[at];
    }
    const MatrixXd shares = null.basis.weights().transpose() * products_with_tangent;
    const MatrixXd beyond = squares - shares.transpose() * shares;
    if (!(beyond.trace() > 1e-6 * squares.trace())) continue;
    explained[row] = products.dot(pseudo_inverse(beyond) * products);
  }
  return explained;
}

/// The times at which a step may well be, in place of a grid: what each row would explain is known,
/// and noise that has nearly swallowed a step shows it in one row.
void look_at_likely_rows(const CandidateRoom& room, const NullHypothesis& null,
                         const MatrixXd& columns, Candidate& candidate) {
  constexpr int most_peaks = 3;
  constexpr Index around = 2;  // rows
  const RowLayout& layout = room.fit().layout;
  const std::vector<double> times = room.times();
  VectorXd explained = explained_by_steps(null, columns);
  VectorXd jumps = VectorXd::Zero(layout.rows);
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    jumps += null.white_residual.segment(layout.first(j), layout.rows).cwiseAbs2();
  }
  // A step over the first or last few rows is an outlier as well.
  const Index side = std::min(layout.rows / 4, std::max<Index>(10, layout.rows / 50));
  for (VectorXd* score : {&explained, &jumps}) {
    score->head(side).setZero();
    score->tail(side).setZero();
  }
  const Index apart = std::max<Index>(2 * around, layout.rows / 40);
  candidate.shape.values.clear();
  for (VectorXd* score : {&explained, &jumps}) {
    for (int peak = 0; peak < most_peaks; ++peak) {
      Index row = 0;
      if (!(score->maxCoeff(&row) > 0.0)) break;
      for (Index near = row - around; near <= row + around; ++near) {
        if (near < side || near >= layout.rows - side) continue;
        candidate.shape.values.push_back(times[static_cast<std::size_t>(near)]);
      }
      const Index first = std::max<Index>(0, row - apart);
      score->segment(first, std::min(layout.rows, row + apart + 1) - first).setZero();
    }
  }
  candidate.shape.tried = static_cast<double>(layout.rows);
}

Projection project_columns(const NullHypothesis& null, const Trial& trial,
                           const CandidateColumns& columns) {
  return project(null.basis, columns.whole, columns.varying, trial.least_visibility);
}

/// What the screen needs of columns X beyond the tangent, in one pass; e is the null's residual.
struct ScreenProducts {
  MatrixXd R = {};                   // their triangular factor
  std::vector<MatrixXd> plain = {};  // [X e]' [X e] of each output
  MatrixXd white_square = {};        // X'X, whitened and beyond the whitened tangent
  VectorXd white_product = {};       // X'e likewise

  VectorXd product() const {
    const Index q = R.cols();
    VectorXd sum = VectorXd::Zero(q);
    for (const MatrixXd& of_output : plain) sum += of_output.col(q).head(q);
    return sum;
  }
};

ScreenProducts multiply_for_screen(const NullHypothesis& null, const Columns& X) {
  const RowLayout& layout = null.fit().layout;
  const Index q = X.cols();
  TriangularFactor factor(static_cast<int>(q));
  ScreenProducts products{.white_square = MatrixXd::Zero(q, q), .white_product = VectorXd::Zero(q)};
  MatrixXd shares = MatrixXd::Zero(null.white_basis.cols(), q);
  MatrixXd columns(layout.rows, q);
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    const Index first = layout.first(j);
    MatrixXd plain = MatrixXd::Zero(q + 1, q + 1);
    for (Index row = 0; row < layout.rows; row += panel_rows) {
      auto part = columns.middleRows(row, std::min(panel_rows, layout.rows - row));
      X.fill(first + row, part);
      MatrixXd panel(part.rows(), q + 1);
      panel << part, null.residual.segment(first + row, part.rows());
      numerics::add_square(panel, plain);
      panel.conservativeResize(Eigen::NoChange, q);
      factor.absorb(panel);
    }
    products.plain.push_back(std::move(plain));
    null.whiteners[j].apply(columns);
    numerics::add_square(columns, products.white_square);
    numerics::add_transposed_product(null.white_basis.middleRows(first, layout.rows), columns,
                                     shares);
    numerics::add_transposed_product(columns, null.white_residual.segment(first, layout.rows),
                                     products.white_product);
  }
  products.R = factor.matrix();
  products.white_square -= shares.transpose() * shares;
  return products;
}

/// predict_drop() of X times `directions`.
double predict_drop(const NullHypothesis& null, const ScreenProducts& products,
                    const MatrixXd& directions) {
  const RowLayout& layout = null.fit().layout;
  const Index q = directions.rows();
  VectorXd change(q + 1);  // of the residual, [X e] times this
  change << -directions * (directions.transpose() * products.product()), 1.0;
  double square = 0.0;
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    const double weight = layout.outputs[j].weight;
    square += weight * weight * change.dot(products.plain[j] * change);
  }
  return 1.0 - std::sqrt(std::max(0.0, square) / static_cast<double>(layout.count())) /
                   total_rmse(layout, null.fit().residual);
}

/// The estimate of the effect from that of its basis.
void keep_estimate(const MatrixXd& to_effect, const MatrixXd& absorbed, const VectorXd& of_basis,
                   const MatrixXd& covariance, Trial& trial) {
  trial.estimate = to_effect * of_basis;
  trial.absorbed = absorbed * trial.estimate;
  trial.covariance = to_effect * covariance * to_effect.transpose();
  trial.freedom = static_cast<int>(to_effect.cols());
}

void set_tails(const NoiseTails& tails, Trial& trial) {
  const double scan = log10_scan(trial);
  trial.tails = {std::min(0.0, scan + tails.either), std::min(0.0, scan + tails.beside)};
  combine_tails(trial);
}

}  // namespace

Projection project_trial(const CandidateRoom& room, const NullHypothesis& null, const Trial& trial,
                         double shape) {
  return project_columns(null, trial, room.columns(trial.candidate, shape));
}

double log10_scan(const Trial& trial) { return std::log10(trial.candidate.shape.tried); }

void screen(const CandidateRoom& room, const NullHypothesis& null, Trial& trial) {
  const MatrixXd* stepping = room.columns_of(trial.candidate.stepping_port);
  if (stepping != nullptr) look_at_likely_rows(room, null, *stepping, trial.candidate);
  double best_white = 1.0;  // log10 of the tail
  double best_plain = 1.0;
  for (const double shape : trial.candidate.shape.values) {
    const CandidateColumns columns = room.columns(trial.candidate, shape);
    const BeyondTangent beyond = measure_beyond(null.basis, columns.whole, columns.varying);
    if (beyond.columns.cols() == 0) continue;
    const ScreenProducts products = multiply_for_screen(null, beyond.columns);
    const auto [visibility, directions] = find_seen_directions(products.R, trial.least_visibility);
    trial.visibility = std::max(trial.visibility, visibility);
    if (directions.cols() == 0) continue;
    ShapeScore score{.shape = shape, .freedom = static_cast<int>(directions.cols())};
    score.reduction = (directions.transpose() * products.product()).squaredNorm();
    const VectorXd product = directions.transpose() * products.white_product;
    const MatrixXd covariance =
        pseudo_inverse(directions.transpose() * products.white_square * directions);
    const VectorXd step = covariance * product;
    score.white = product.dot(step);
    score.white = numerics::log10_chi_squared_tail(score.white, score.freedom);
    score.plain = numerics::log10_chi_squared_tail(score.reduction, score.freedom);
    best_plain = std::min(best_plain, score.plain);
    trial.scores.push_back(score);
    if (!(score.white < best_white)) continue;
    best_white = score.white;
    trial.shape = shape;
    keep_estimate(beyond.to_coefficients * directions, beyond.absorbed, step, covariance, trial);
    trial.predicted_drop = predict_drop(null, products, directions);
  }
  trial.visible = !trial.scores.empty();
  if (!trial.visible) return;
  const double scans = log10_scan(trial);
  trial.log10_white = std::min(0.0, scans + best_white);
  trial.log10_plain = std::min(0.0, scans + best_plain);
  trial.log10_p = trial.log10_white;
}

void estimate_plainly(const RowLayout& layout, const Projection& added, const VectorXd& residual,
                      Trial& trial) {
  trial.visible = added.visible() > 0;
  trial.visibility = added.visibility;
  const Index q = added.visible();
  keep_estimate(added.to_effect, added.absorbed, multiply_transposed(layout, added.basis, residual),
                MatrixXd::Identity(q, q), trial);
}

std::vector<double> best_shapes(const Trial& trial) {
  const auto by_white = std::ranges::min_element(trial.scores, {}, &ShapeScore::white);
  const auto by_plain = std::ranges::min_element(trial.scores, {}, &ShapeScore::plain);
  if (by_plain == by_white) return {by_white->shape};
  return {by_white->shape, by_plain->shape};
}

void test(const CandidateRoom& room, const NullHypothesis& null, Trial& trial) {
  NoiseTails least{infinity, infinity};
  const std::vector<double> shapes =
      is_decided_by_bounds(trial) ? std::vector{trial.shape} : best_shapes(trial);
  for (const double shape : shapes) {
    Projection added = project_trial(room, null, trial, shape);
    added.basis = keep_few(room.fit().layout, added.basis);
    const NoiseTest::Ratios ratios = null.test->compare(added.basis);
    const auto q = added.visible();
    const NoiseTails tails = NoiseTest::tails(ratios, static_cast<int>(q));
    if (!(tails.log10_p() < least.log10_p())) continue;
    least = tails;
    trial.ratios = ratios;
    trial.floor = null.test->floor(ratios.with.noise);
    trial.shape = shape;
    keep_estimate(added.to_effect, added.absorbed, ratios.with.coefficients.tail(q),
                  ratios.with.covariance.bottomRightCorner(q, q), trial);
    trial.predicted_drop = predict_drop(null, added.basis);
  }
  trial.slow = is_slow(room, trial.candidate, trial.shape);
  trial.tested = true;
  set_tails(least, trial);
}

bool is_bounded(const Trial& trial) {
  constexpr double well_seen = 0.5;
  return trial.bounded && trial.bounded->share_seen >= well_seen;
}

/// Noise that is so many times as large raises a small probability to about one over that power.
void combine_tails(Trial& trial) {
  double log10_p = trial.tails.log10_p();
  if (trial.bounded && is_bounded(trial)) {
    log10_p = is_decided_by_bounds(trial) ? trial.bounded->log10_p
                                          : std::max(log10_p, trial.bounded->log10_p);
  }
  trial.log10_p = log10_p / trial.inflation;
}

bool is_decided_by_bounds(const Trial& trial) {
  return trial.bounded && trial.slow && trial.bounded->left < most_left;
}

bool bound(const InstrumentTail& tail, Trial& trial) {
  const double log10_p = tail.log10_p + log10_scan(trial);
  if (trial.bounded && !(log10_p < trial.bounded->log10_p)) return false;
  trial.bounded = tail;
  trial.bounded->log10_p = std::min(0.0, log10_p);
  combine_tails(trial);
  return true;
}

bool is_smooth(const RowLayout& layout, const Columns& columns) {
  constexpr double little = 0.25;  // of what two far apart differ by, squared
  const Index lag = std::max<Index>(1, layout.rows / 100);
  double changes = 0.0;
  double spread = 0.0;
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    const MatrixXd own = columns.rows(layout.first(j), layout.rows);
    for (const auto part : own.colwise()) {
      const Index pairs = layout.rows - lag;
      changes += (part.tail(pairs) - part.head(pairs)).squaredNorm() / static_cast<double>(pairs);
      spread += 2.0 * (part.array() - part.mean()).square().mean();
    }
  }
  return changes < little * spread;
}

void calibrate(const CandidateRoom& room, const NullHypothesis& null, NoiseTest::Drawing drawing,
               base::ThreadPool& pool, Trial& trial) {
  Projection added = project_trial(room, null, trial, trial.shape);
  added.basis = keep_few(room.fit().layout, added.basis);
  drawing.smooth = is_smooth(room.fit().layout, added.basis);
  set_tails(null.test->calibrate(trial.ratios, added.basis, drawing, pool), trial);
}

bool is_slow(const CandidateRoom& room, const Candidate& candidate, double shape) {
  const RowLayout& layout = room.fit().layout;
  RowLayout of_drivers = layout;
  of_drivers.outputs.resize(1);
  return std::ranges::all_of(candidate.effects, [&](const Effect& effect) {
    return effect.driver ? is_smooth(of_drivers, room.functions_of(effect, shape))
                         : is_smooth(layout, room.columns(candidate, shape).whole);
  });
}

bool is_flexible_in_time(const Candidate& candidate) {
  return std::ranges::any_of(candidate.effects, [](const Effect& effect) {
    return effect.driver && effect.driver->functions() > 1 && effect.driver->input() &&
           effect.driver->input()->name == "time";
  });
}

void doubt(const CandidateRoom& room, const NullHypothesis& null, Trial& trial) {
  if (!room.follows_path()) return;
  const Projection added = project_trial(room, null, trial, trial.shape);
  const double tail = log10_block_tail(null, added.basis.dense(room.fit().layout));
  const double corrected = std::min(0.0, log10_scan(trial) + tail);
  trial.tails = {std::max(trial.tails.either, corrected), std::max(trial.tails.beside, corrected)};
  combine_tails(trial);
}

void hold_out(const CandidateRoom& room, const NullHypothesis& null, Trial& trial) {
  const LinearisedFit& fit = room.fit();
  const CandidateColumns columns = room.columns(trial.candidate, trial.shape);
  const Columns& G = columns.whole;
  if (!room.follows_path() && !is_smooth(fit.layout, G)) {
    trial.folds = whole_segments(fit.layout);
    judge_interpolated(fit.layout, G, trial.folds);
    if (trial.folds.count > 0) trial.held_out = hold_out(fit, G, trial.folds);
    if (trial.held_out.judged) return;
  }
  const Columns added = project_columns(null, trial, columns).basis;
  const VectorXd left = subtract(fit.layout, null.residual, added,
                                 multiply_transposed(fit.layout, added, null.residual));
  // A block left out must be short beside what the driver's functions vary over.
  int functions = 1;
  for (const Effect& effect : trial.candidate.effects) {
    if (effect.driver) functions = std::max(functions, effect.driver->functions());
  }
  int fewest = 5 * (functions + 1);
  if (room.follows_path()) {  // what is left of each segment must tell where it begins
    constexpr int of_each = 4;
    fewest = std::max(fewest, of_each * static_cast<int>(fit.layout.segments.size()));
  }
  trial.folds = interleaved_blocks(fit.layout, correlation_rows(fit.layout, left), fewest);
  judge_interpolated(fit.layout, G, trial.folds);
  trial.held_out = hold_out(fit, G, trial.folds);
}

void confirm(Refits& refits, Trial& trial) {
  const HeldOut confirmed = refits.hold_out(trial.candidate, trial.shape, trial.folds);
  if (!confirmed.judged) return;
  trial.held_out = confirmed;
  trial.refitted = true;
}

}  // namespace sepcal::diagnosis
