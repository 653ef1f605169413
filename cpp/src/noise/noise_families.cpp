// SPDX-License-Identifier: BSD-3-Clause
#include "noise/noise_families.hpp"

#include <algorithm>
#include <cmath>

#include "base/stop.hpp"
#include "noise/autoregression.hpp"
#include "noise/autoregression_filter.hpp"
#include "noise/noise_autocovariance.hpp"
#include "noise/noise_room.hpp"
#include "numerics/lanes.hpp"
#include "sepcal/detail/quantity.hpp"

namespace sepcal::noise {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;
using numerics::lane_count;
using numerics::Lanes;
using numerics::load;
using numerics::store;

constexpr std::array grid_of_d{0.0, 0.15, 0.3, 0.45, 0.6, 0.8, 0.999};
constexpr double differences_from = 0.5;
constexpr std::array white_shares{0.0, 0.1, 0.25, 0.45, 0.65, 0.8, 0.9, 0.96, 0.99, 0.999};
constexpr int correlation_times = 10;
constexpr Index longest_settling = 4096;  // rows that gains are kept for

/// Kalman filters of members side by side: a state's decay, and what each does at a row.
struct FilterBank {
  const double* decays;
  const double* gains;       // members x rows of a run
  const double* precisions;  // likewise, of the innovations
  Index members;             // a multiple of lanes_at_once
  Index settled;             // the last row, which stands for all later ones
};

constexpr Index groups_at_once = 4;  // whose filters run at once, as each waits for its own state
constexpr Index lanes_at_once = groups_at_once * lane_count;

// NOLINTBEGIN(*-pointer-arithmetic,*-c-arrays,*-constant-array-index): lanes of a register.

/// Adds each member's sum of squared innovations over their variances, of a run.
SEPCAL_EVERY_WIDTH void add_squares(const FilterBank& bank, const double* e, Index rows,
                                    double* squares) {
  for (Index first = 0; first < bank.members; first += lanes_at_once) {
    Lanes decay[groups_at_once];
    Lanes state[groups_at_once] = {};
    Lanes square[groups_at_once] = {};
    for (Index g = 0; g < groups_at_once; ++g) load(bank.decays + first + g * lane_count, decay[g]);
    for (Index t = 0; t < rows; ++t) {
      const Index at = std::min(t, bank.settled) * bank.members + first;
      for (Index g = 0; g < groups_at_once; ++g) {
        Lanes gain;
        Lanes precision;
        load(bank.gains + at + g * lane_count, gain);
        load(bank.precisions + at + g * lane_count, precision);
        const Lanes innovation = e[t] - state[g];
        square[g] += innovation * innovation * precision;
        state[g] = decay[g] * (state[g] + gain * innovation);
      }
    }
    for (Index g = 0; g < groups_at_once; ++g) {
      for (Index lane = 0; lane < lane_count; ++lane) {
        squares[first + g * lane_count + lane] += square[g][lane];
      }
    }
  }
}

/// One member's filter.
struct MarkovFilter {
  double decay;
  const double* gain;       // of each row until they settle
  const double* precision;  // the root of it, of the innovations
  Index settled;            // the last row, which stands for all later ones
};

/// Up to lane_count columns of a run become innovations, each of unit variance.
SEPCAL_EVERY_WIDTH void whiten_side_by_side(const MarkovFilter& filter, double* columns,
                                            Index stride, Index count, Index rows) {
  Lanes state = {};
  double values[lane_count] = {};
  for (Index t = 0; t < rows; ++t) {
    const Index at = std::min(t, filter.settled);
    for (Index k = 0; k < count; ++k) values[k] = columns[k * stride + t];
    Lanes innovation;
    load(values, innovation);
    innovation -= state;
    state = filter.decay * (state + filter.gain[at] * innovation);
    innovation *= filter.precision[at];
    store(innovation, values);
    for (Index k = 0; k < count; ++k) columns[k * stride + t] = values[k];
  }
}

// NOLINTEND(*-pointer-arithmetic,*-c-arrays,*-constant-array-index)

/// The variance of the sum of `rows` increments (1 - B)^delta u = w.
double variance_of_sum(double delta, Index rows) {
  const VectorXd gamma = find_moments(delta, VectorXd(), rows).autocovariance;
  double variance = 0.0;
  double slope = gamma[0];
  for (Index h = 0; h < rows; ++h) {
    if (h > 0) slope += 2.0 * gamma[h];
    variance += slope;
  }
  return variance;
}

}  // namespace

NoiseFamilies::NoiseFamilies(const std::vector<Segment>& runs) : lengths_(find_lengths(runs)) {
  for (const Index length : lengths_) rows_ += length;
  for (const double d : grid_of_d) fractions_.push_back(make_fraction(d));
  const Index longest = *std::ranges::max_element(lengths_);
  const double shortest_time = 2.0;
  const double longest_time = 2.0 * static_cast<double>(std::max<Index>(longest, 4));
  gauss_markov_.push_back(make_gauss_markov(1.0, 1.0));
  for (int i = 0; i < correlation_times; ++i) {
    const double time =
        shortest_time * std::pow(longest_time / shortest_time, i / (correlation_times - 1.0));
    for (const double white : white_shares) gauss_markov_.push_back(make_gauss_markov(time, white));
  }
  Index settled = 0;
  for (const GaussMarkov& process : gauss_markov_) settled = std::max(settled, process.gain.size());
  const auto members = static_cast<Index>(gauss_markov_.size());
  const Index lanes = (members + lanes_at_once - 1) / lanes_at_once * lanes_at_once;
  decays_ = VectorXd::Zero(lanes);
  gains_ = precisions_ = MatrixXd::Zero(lanes, settled);
  log_variances_ = VectorXd::Zero(members);
  for (Index m = 0; m < members; ++m) {
    const GaussMarkov& process = gauss_markov_[static_cast<std::size_t>(m)];
    const Index own = process.gain.size();
    decays_[m] = process.a;
    gains_.row(m).setConstant(process.gain[own - 1]);
    precisions_.row(m).setConstant(std::pow(process.deviation[own - 1], -2));
    gains_.row(m).head(own) = process.gain;
    precisions_.row(m).head(own) = process.deviation.cwiseAbs2().cwiseInverse();
    for (const Index length : lengths_) {
      const Index first = std::min(length, own);
      log_variances_[m] +=
          2.0 * process.deviation.head(first).array().log().sum() +
          2.0 * static_cast<double>(length - first) * std::log(process.deviation[own - 1]);
    }
  }
}

NoiseFamilies::Fraction NoiseFamilies::make_fraction(double d) const {
  const bool differences = d >= differences_from;
  const double delta = differences ? d - 1.0 : d;
  std::vector<Index> blocks = find_blocks(lengths_, differences);
  ArfimaFactor factor(delta, VectorXd(), blocks);
  double log_determinant = factor.log_determinant(blocks);
  std::vector<double> deviations;
  if (differences) {
    for (const Index length : lengths_) {
      const double variance = variance_of_sum(delta, length);
      deviations.push_back(std::sqrt(variance));
      log_determinant += std::log(variance);
    }
  }
  return {differences, std::move(blocks), std::move(factor), std::move(deviations),
          log_determinant};
}

NoiseFamilies::GaussMarkov NoiseFamilies::make_gauss_markov(double rows, double white) const {
  constexpr double settled = 1e-12;
  const Index longest = std::min(longest_settling, *std::ranges::max_element(lengths_));
  GaussMarkov process{std::exp(-1.0 / rows), VectorXd(longest), VectorXd(longest)};
  const double gauss_markov = 1.0 - white;
  double P = gauss_markov;  // variance of g as predicted
  for (Index t = 0; t < longest; ++t) {
    const double F = P + white;
    process.gain[t] = P / F;
    process.deviation[t] = std::sqrt(F);
    const double next =
        process.a * process.a * P * white / F + gauss_markov * (1.0 - process.a * process.a);
    if (std::abs(next - P) <= settled * P) {
      process.gain.conservativeResize(t + 1);
      process.deviation.conservativeResize(t + 1);
      break;
    }
    P = next;
  }
  return process;
}

void NoiseFamilies::difference(const Fraction& fraction, Ref<VectorXd> x) const {
  if (!fraction.differences) {
    fraction.factor.whiten(x, fraction.blocks);
    return;
  }
  Index first = 0;
  for (std::size_t i = 0; i < lengths_.size(); ++i) {
    const Index rest = lengths_[i] - 1;
    for (Index t = first + rest; t > first; --t) x[t] -= x[t - 1];
    x[first] /= fraction.first_deviation[i];
    fraction.factor.whiten(x.segment(first + 1, rest));
    first += lengths_[i];
  }
}

void NoiseFamilies::difference_backwards(const Fraction& fraction, Ref<VectorXd> x) const {
  Index first = 0;
  for (std::size_t i = 0; i < lengths_.size(); ++i) {
    auto run = x.segment(first, lengths_[i]);
    first += lengths_[i];
    if (!fraction.differences) {
      fraction.factor.whiten_backwards(run);
      continue;
    }
    const Index rest = run.size() - 1;
    fraction.factor.whiten_backwards(run.tail(rest));
    run[0] /= fraction.first_deviation[i];
    for (Index t = 0; t < rest; ++t) run[t] -= run[t + 1];
  }
}

VectorXd NoiseFamilies::gather_blocks(const Fraction& fraction, const VectorXd& x) const {
  if (!fraction.differences) return x;
  VectorXd rows(rows_ - static_cast<Index>(lengths_.size()));
  Index from = 0;
  Index to = 0;
  for (const Index length : lengths_) {
    rows.segment(to, length - 1) = x.segment(from + 1, length - 1);
    from += length;
    to += length - 1;
  }
  return rows;
}

MatrixXd NoiseFamilies::differences(const VectorXd& e) const {
  MatrixXd all = e.replicate(1, static_cast<Index>(fractions_.size()));
  for (std::size_t k = 0; k < fractions_.size(); ++k) {
    base::heed_stop();
    difference(fractions_[k], all.col(static_cast<Index>(k)));
  }
  return all;
}

NoiseMember NoiseFamilies::find_fractional(const Ref<const MatrixXd>& differences,
                                           int order) const {
  NoiseMember best;
  best.minus_two_log_likelihood = infinity;
  const auto n = static_cast<double>(rows_);
  for (std::size_t k = 0; k < fractions_.size(); ++k) {
    base::heed_stop();
    const Fraction& fraction = fractions_[k];
    const auto y = differences.col(static_cast<Index>(k));
    const VectorXd rows = gather_blocks(fraction, y);
    const BurgFit burg = fit_burg(rows, fraction.blocks, order);
    // Burg's criterion profiles sigma over its rows; the first ones of the runs join them.
    const auto m = static_cast<double>(rows.size());
    const double log_ratio = burg.log_ratio[order];
    const double square = m * std::exp((burg.criterion[order] - log_ratio) / m) +
                          std::max(0.0, y.squaredNorm() - rows.squaredNorm());
    const double value = n * std::log(square / n) + log_ratio + fraction.log_determinant;
    if (!(value < best.minus_two_log_likelihood)) continue;
    best = {NoiseFamily::fractional, k, burg.partial, std::sqrt(square / n), value};
  }
  return best;
}

NoiseMember NoiseFamilies::find_gauss_markov(const VectorXd& e) const {
  const FilterBank bank{decays_.data(), gains_.data(), precisions_.data(), gains_.rows(),
                        gains_.cols() - 1};
  VectorXd squares = VectorXd::Zero(gains_.rows());
  Index first = 0;
  for (const Index length : lengths_) {
    add_squares(bank, e.data() + first, length, squares.data());
    first += length;
  }
  const ArrayXd square = squares.head(static_cast<Index>(gauss_markov_.size()));
  const auto n = static_cast<double>(rows_);
  NoiseMember best{.family = NoiseFamily::gauss_markov};
  Index least = 0;
  best.minus_two_log_likelihood =
      (n * (square / n).log() + log_variances_.array()).minCoeff(&least);
  best.at = static_cast<std::size_t>(least);
  best.sigma = std::sqrt(square[least] / n);
  return best;
}

NoiseMember NoiseFamilies::find(NoiseFamily family, const VectorXd& e, int order) const {
  return family == NoiseFamily::fractional ? find_fractional(differences(e), order)
                                           : find_gauss_markov(e);
}

void NoiseFamilies::whiten_differenced(const NoiseMember& member, Ref<MatrixXd> columns) const {
  const Index skipped = fractions_[member.at].differences ? 1 : 0;
  for (auto column : columns.colwise()) {
    Index first = 0;
    for (const Index length : lengths_) {
      whiten_autoregression(member.partial, column.segment(first + skipped, length - skipped));
      first += length;
    }
  }
  columns /= member.sigma;
}

LaggedSquares NoiseFamilies::lagged_squares(std::size_t at, MatrixXd columns, int order) const {
  const Fraction& fraction = fractions_[at];
  for (auto column : columns.colwise()) difference(fraction, column);
  return {columns, fraction.blocks, fraction.differences ? 1 : 0, order};
}

void NoiseFamilies::whiten_backwards(const NoiseMember& member, Ref<VectorXd> column) const {
  if (member.family == NoiseFamily::fractional) {
    const Fraction& fraction = fractions_[member.at];
    const Index skipped = fraction.differences ? 1 : 0;
    Index first = 0;
    for (const Index length : lengths_) {
      whiten_autoregression_backwards(member.partial,
                                      column.segment(first + skipped, length - skipped));
      first += length;
    }
    difference_backwards(fraction, column);
    column /= member.sigma;
    return;
  }
  const GaussMarkov& process = gauss_markov_[member.at];
  const Index settled = process.gain.size() - 1;
  Index first = 0;
  for (const Index length : lengths_) {
    double state = 0.0;  // what a row's state does to all later rows
    for (Index t = length - 1; t >= 0; --t) {
      const Index at = std::min(t, settled);
      const double fed = process.a * state;
      const double innovation = column[first + t] / process.deviation[at] + process.gain[at] * fed;
      column[first + t] = innovation;
      state = fed - innovation;
    }
    first += length;
  }
  column /= member.sigma;
}

void NoiseFamilies::whiten(const NoiseMember& member, Ref<MatrixXd> columns) const {
  if (member.family == NoiseFamily::fractional) {
    for (auto column : columns.colwise()) difference(fractions_[member.at], column);
    whiten_differenced(member, columns);
    return;
  }
  const GaussMarkov& process = gauss_markov_[member.at];
  const VectorXd precision = (member.sigma * process.deviation).cwiseInverse();
  for (Index first = 0; first < columns.cols(); first += lane_count) {
    const Index count = std::min(lane_count, columns.cols() - first);
    Index row = 0;
    for (const Index length : lengths_) {
      whiten_side_by_side(
          {process.a, process.gain.data(), precision.data(), process.gain.size() - 1},
          &columns(row, first), columns.outerStride(), count, length);
      row += length;
    }
  }
}

void NoiseFamilies::colour(const NoiseMember& member, Ref<VectorXd> innovations) const {
  Index first = 0;
  for (std::size_t i = 0; i < lengths_.size(); ++i) {
    auto run = innovations.segment(first, lengths_[i]);
    first += lengths_[i];
    if (member.family == NoiseFamily::fractional) {
      const Fraction& fraction = fractions_[member.at];
      const Index skipped = fraction.differences ? 1 : 0;
      auto block = run.tail(run.size() - skipped);
      colour_autoregression(member.partial, block);
      fraction.factor.colour(block);
      if (fraction.differences) {
        run[0] *= fraction.first_deviation[i];
        for (Index t = 1; t < run.size(); ++t) run[t] += run[t - 1];
      }
      continue;
    }
    const GaussMarkov& process = gauss_markov_[member.at];
    const Index settled = process.gain.size() - 1;
    double state = 0.0;
    for (Index t = 0; t < run.size(); ++t) {
      const Index at = std::min(t, settled);
      const double innovation = run[t] * process.deviation[at];
      run[t] = state + innovation;
      state = process.a * (state + process.gain[at] * innovation);
    }
  }
  innovations *= member.sigma;
}

}  // namespace sepcal::noise
