// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/instrument_noise.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "diagnosis/projection.hpp"
#include "numerics/normal_equations.hpp"
#include "numerics/order_statistics.hpp"
#include "numerics/tails.hpp"
#include "sepcal/error.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index most_filtered_rows = 800;
constexpr std::array correlation_times{10.0, 60.0, 300.0, 1500.0};  // [s]
constexpr double least_white = 1e-3;                                // of the RMSE
constexpr double of_white = 1.0;  // how far an output wanders of which nothing is known

/// Of noise that neighbouring rows do not share, by second differences, which hardly see what is
/// slow; no single one counts for more than four robust standard deviations.
double white_variance(const std::vector<Segment>& runs, const Eigen::Ref<const VectorXd>& e) {
  constexpr double robust = 1.4826;
  constexpr double of_differences = 6.0;  // 1 + 4 + 1
  std::vector<double> sizes;
  for (const Segment& run : runs) {
    for (std::size_t row = run.first + 1; row + 1 < run.last; ++row) {
      const auto at = static_cast<Index>(row);
      sizes.push_back(std::abs(e[at - 1] - 2.0 * e[at] + e[at + 1]));
    }
  }
  const double least = least_white * least_white * e.squaredNorm() / static_cast<double>(e.size());
  if (sizes.empty()) return least;
  const double largest = 4.0 * robust * numerics::upper_median(sizes);
  double sum = 0.0;
  for (const double size : sizes) {
    const double counted = largest > 0.0 ? std::min(size, largest) : size;
    sum += counted * counted;
  }
  return std::max(least, sum / (of_differences * static_cast<double>(sizes.size())));
}

/// Half the mean square by which rows so far apart differ.
double half_square_apart(const std::vector<Segment>& runs, const VectorXd& e, Index lag) {
  double sum = 0.0;
  double pairs = 0.0;
  for (const Segment& run : runs) {
    const Index count = static_cast<Index>(run.rows()) - lag;
    if (count <= 0) continue;
    const auto first = static_cast<Index>(run.first);
    sum += (e.segment(first + lag, count) - e.segment(first, count)).squaredNorm();
    pairs += static_cast<double>(count);
  }
  return pairs > 0.0 ? 0.5 * sum / pairs : not_a_number;
}

/// The mean time of each of the reduced rows.
std::vector<double> reduce_times(const RowLayout& full, const ReducedRows& rows,
                                 const std::vector<double>& times) {
  std::vector<double> reduced;
  for (const Segment& run : full.runs) {
    for (std::size_t row = run.first; row < run.last;
         row += static_cast<std::size_t>(rows.stride)) {
      const std::size_t last = std::min(row + static_cast<std::size_t>(rows.stride), run.last);
      double sum = 0.0;
      for (std::size_t i = row; i < last; ++i) sum += times[i];
      reduced.push_back(sum / static_cast<double>(last - row));
    }
  }
  return reduced;
}

/// -2 ln L of the residual, the last of the columns, beyond the others, but for a constant,
/// whatever its size: by products alone, for what is asked often.
double minus_two_log_likelihood(const GaussMarkovFilter& filter, const MatrixXd& columns) {
  const MatrixXd white = filter.whiten(columns);
  const Index others = white.cols() - 1;
  const MatrixXd products = white.transpose() * white;
  const numerics::ExplainedSquares by = numerics::explained_squares(
      products.topLeftCorner(others, others), products.col(others).head(others),
      products.diagonal().head(others).cwiseSqrt());
  const auto count = static_cast<double>(white.rows());
  const double left = products(others, others) - by.square;
  return count * std::log(left / count) + filter.log_determinant();
}

}  // namespace

/// Half the squares apart are white + variance (1 - exp(-lag / rows)): least squares in the two for
/// each of some times.
ShortNoise short_noise(const std::vector<Segment>& runs, const VectorXd& e) {
  constexpr std::array<Index, 9> lags{1, 2, 3, 5, 8, 13, 21, 34, 55};
  constexpr std::array times{1.5, 3.0, 6.0, 12.0, 24.0};  // rows
  constexpr double of_record = 1.0 / 40.0;                // the longest of both
  const double longest = of_record * static_cast<double>(e.size());
  std::vector<double> squares;
  for (const Index lag : lags) {
    if (static_cast<double>(lag) > std::max(3.0, longest)) break;
    const double square = half_square_apart(runs, e, lag);
    if (std::isfinite(square)) squares.push_back(square);
  }
  ShortNoise best{.white = white_variance(runs, e)};
  if (squares.size() < 3) return best;
  const auto count = static_cast<Index>(squares.size());
  const Eigen::Map<const VectorXd> measured(squares.data(), count);
  const auto off = [&](const VectorXd& fitted) {  // as shares of what is measured
    return ((fitted - measured).array() / measured.array()).square().sum();
  };
  constexpr double worth_it = 0.5;  // of what white noise alone leaves
  double least = worth_it * off(VectorXd::Constant(count, best.white));
  for (const double time : times) {
    if (time > longest) break;
    MatrixXd columns(count, 2);
    for (Index k = 0; k < count; ++k) {
      const auto lag = static_cast<double>(lags[static_cast<std::size_t>(k)]);
      columns.row(k) << 1.0, 1.0 - std::exp(-lag / time);
    }
    const MatrixXd weighted = columns.array().colwise() / measured.array();
    Eigen::Vector2d fitted = weighted.colPivHouseholderQr().solve(VectorXd::Ones(count));
    if (fitted[0] < 0.0) {  // all of it goes together
      fitted[0] = 0.0;
      fitted[1] = weighted.col(1).sum() / weighted.col(1).squaredNorm();
    }
    if (!(fitted[1] > 0.0) || !(off(columns * fitted) < least)) continue;
    least = off(columns * fitted);
    best = {fitted[0], fitted[1], time};
  }
  const double floor = least_white * least_white * e.squaredNorm() / static_cast<double>(e.size());
  best.white = std::max(best.white, floor);
  return best;
}

/// A component of an error that wanders: what a unit of it does to each output of each row.
struct InstrumentNoise::Source {
  std::size_t bound = 0;
  VectorXd slopes = {};  // output after output
};

/// Noise from row to row beside wandering of known sizes, and what it makes of the null hypothesis.
/// What is whitened stands by time, the outputs of each row side by side.
struct InstrumentNoise::Noise {
  GaussMarkovFilter filter;
  MatrixXd basis = {};         // orthonormal, of the whitened tangent
  VectorXd residual = {};      // whitened and orthogonal to it
  double left = not_a_number;  // the variance beside all candidates, once that is known

  /// The same, no less than 1.
  double variance() const { return left > 1.0 ? left : 1.0; }

  /// The least of that and of another.
  double least_left(double other) const { return left < other ? left : other; }

  MatrixXd whiten(const MatrixXd& columns) const { return filter.whiten(columns); }

  /// Whitened, and orthogonal to the tangent.
  MatrixXd whiten_beyond(const MatrixXd& columns) const {
    return remove_span(basis, whiten(columns));
  }

  /// The sum of squares of the residual, the last of the columns, whitened and beyond the others.
  double sum_left(const MatrixXd& columns) const {
    const MatrixXd white = whiten(columns);
    const MatrixXd others = orthonormal_basis(white.leftCols(white.cols() - 1));
    return remove_span(others, white.rightCols<1>()).squaredNorm();
  }

  double freedom_beside(Index columns) const {
    return static_cast<double>(residual.size() - basis.cols() - columns);
  }

  /// What columns that are whitened and orthogonal to the tangent explain of the residual.
  numerics::ExplainedSquares explained_by(const Eigen::Ref<const MatrixXd>& white) const {
    return numerics::explained_squares(white.transpose() * white, white.transpose() * residual,
                                       white.colwise().norm().transpose());
  }

  /// The variance that is left beside them.
  double left_beside(const numerics::ExplainedSquares& by) const {
    return (residual.squaredNorm() - by.square) / std::max(1.0, freedom_beside(by.directions));
  }

  /// log10 of the tail of what they explain, where noise has that variance but no less than 1.
  double log10_tail(const numerics::ExplainedSquares& by, double variance) const {
    const auto q = static_cast<double>(by.directions);
    const double freedom = freedom_beside(by.directions);
    if (q == 0.0 || !(freedom > 0.0)) return 0.0;
    return numerics::log10_f_tail(by.square / q / std::max(1.0, variance), q, freedom);
  }
};

InstrumentNoise::InstrumentNoise(CandidateRoom& room, const EffectKit& kit,
                                 const NullHypothesis& null,
                                 const std::map<std::string, double>& sizes)
    : null_(null), rows_(null.fit().layout, most_filtered_rows, true), bounds_(kit.error_budget) {
  const RowLayout& layout = null.fit().layout;
  times_ = reduce_times(layout, rows_, room.times());
  known_ = MatrixXd(rows_.layout.count(), null.basis.rank() + 1);
  known_ << reduce(null.basis.columns()), reduce(view(null.residual));
  if (bounds_.empty()) {
    for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
      const UsedOutput& output = layout.outputs[j];
      const double white =
          white_variance(layout.runs, null.residual.segment(layout.first(j), layout.rows));
      bounds_.push_back({.name = output.name,
                         .unit = output.unit,
                         .size = of_white * std::sqrt(white) * output.scale,
                         .outputs = {output.name}});
    }
  }
  for (const auto& [name, size] : sizes) {
    const auto known = std::ranges::find(bounds_, name, &ErrorBound::name);
    if (known == bounds_.end()) {
      std::vector<std::string> names;
      for (const ErrorBound& bound : bounds_) names.push_back(bound.name);
      throw Error(
          fmt::format("nothing called '{}' wanders; there is: {}", name, fmt::join(names, ", ")));
    }
    known->size = size;
  }
  for (const ErrorBound& bound : bounds_) {
    const bool may_be_louder = bound.time_s > 0.0 && !sizes.contains(bound.name);
    gusts_at_least_.push_back(may_be_louder ? bound.size : not_a_number);
  }
  add_sources(room, kit);
  find_short_noise(known_.rightCols<1>());
  noises_ = make_noises({1.0, 0.5}, whole());
}

void InstrumentNoise::find_short_noise(const VectorXd& residual) {
  short_.clear();
  for (std::size_t j = 0; j < rows_.layout.outputs.size(); ++j) {
    short_.push_back(
        short_noise(rows_.layout.runs, residual.segment(rows_.layout.first(j), rows_.layout.rows)));
  }
  // What is loud over seconds is as loud over half a minute: turbulence has no bound of its own.
  for (std::size_t b = 0; b < bounds_.size(); ++b) {
    ErrorBound& bound = bounds_[b];
    if (std::isnan(gusts_at_least_[b])) continue;
    bound.size = gusts_at_least_[b];
    for (std::size_t j = 0; j < short_.size(); ++j) {
      const UsedOutput& output = null_.fit().layout.outputs[j];
      if (output.unit != bound.unit) continue;
      bound.size = std::max(bound.size, std::sqrt(short_[j].variance) * output.scale);
    }
  }
}

InstrumentNoise::~InstrumentNoise() = default;

MatrixXd InstrumentNoise::reduce(const Columns& columns) const {
  return rows_.apply(null_.fit().layout, columns);
}

void InstrumentNoise::add_sources(CandidateRoom& room, const EffectKit& kit) {
  const LinearisedFit& fit = null_.fit();
  const auto add = [&](std::size_t bound, const MatrixXd& columns) {
    for (const auto column : columns.colwise()) sources_.push_back({bound, column});
  };
  for (std::size_t b = 0; b < bounds_.size(); ++b) {
    const ErrorBound& bound = bounds_[b];
    for (std::size_t j = 0; j < fit.layout.outputs.size(); ++j) {
      const UsedOutput& output = fit.layout.outputs[j];
      if (std::ranges::find(bound.outputs, output.name) == bound.outputs.end()) continue;
      VectorXd column = VectorXd::Zero(rows_.layout.count());
      column.segment(rows_.layout.first(j), rows_.layout.rows).setConstant(1.0 / output.scale);
      add(b, column);
    }
    for (const int place : bound.corrections) {
      if (place < fit.input_drift.cols()) add(b, reduce(view(fit.input_drift.col(place))));
    }
    const auto port = std::ranges::find(kit.ports, bound.port, &Port::name);
    if (port == kit.ports.end()) continue;
    room.open(*port);
    const MatrixXd* columns = room.columns_of(bound.port);
    if (columns != nullptr) add(b, reduce(view(*columns)));
  }
}

/// The noise from row to row alone, and beside it the errors, all or without those that have a
/// correlation time of their own or these alone, at so many times their sizes.
std::vector<InstrumentNoise::Noise> InstrumentNoise::make_noises(const std::vector<double>& times,
                                                                 const Shares& shares) const {
  const auto sized = [&](const VectorXd& share, double of_slow, double of_timed) {
    VectorXd sizes = share;
    for (std::size_t b = 0; b < bounds_.size(); ++b) {
      sizes[static_cast<Index>(b)] *= bounds_[b].time_s > 0.0 ? of_timed : of_slow;
    }
    return sizes;
  };
  const bool has_timed =
      std::ranges::any_of(bounds_, [](const ErrorBound& bound) { return bound.time_s > 0.0; });
  const VectorXd whole = VectorXd::Ones(static_cast<Index>(bounds_.size()));
  std::vector<Noise> noises;
  noises.push_back(make_noise(sized(whole, 0.0, 0.0), 0.0));
  for (const double size : times) {
    if (has_timed) noises.push_back(make_noise(sized(shares.front(), 0.0, size), 0.0));
    for (std::size_t k = 0; k < correlation_times.size(); ++k) {
      noises.push_back(make_noise(sized(shares[k + 1], size, size), correlation_times[k]));
    }
  }
  if (!has_timed) return noises;
  for (std::size_t k = 0; k < correlation_times.size(); ++k) {
    noises.push_back(make_noise(sized(shares[k + 1], 1.0, 0.0), correlation_times[k]));
  }
  return noises;
}

InstrumentNoise::Shares InstrumentNoise::whole() const {
  return Shares(correlation_times.size() + 1, VectorXd::Ones(static_cast<Index>(bounds_.size())));
}

/// Of each bound, as far as the residual may wander beside the others: a half is taken while it is
/// clearly likelier than the whole. Gusts have many scales, for which one process stands in: where
/// they are loud nothing is ruled out.
VectorXd InstrumentNoise::find_share(const VectorXd& whole, double time_s) const {
  constexpr double clearly_likelier = 10.0;  // in -2 ln L
  constexpr double least = 1.0 / 32.0;
  constexpr double loud = 0.5;
  constexpr double middle = std::numbers::sqrt2 / 2.0;  // of a whole and its half
  VectorXd share = whole;
  const auto fits = [&] {
    return sepcal::diagnosis::minus_two_log_likelihood(filter(middle * share, time_s), known_);
  };
  double now = fits();
  bool is_open = true;
  while (is_open) {
    is_open = false;
    for (double& one : share) {
      if (!(one > least)) continue;
      one *= 0.5;
      const double half = fits();
      if (half < now - clearly_likelier) {
        now = half;
        is_open = true;
      } else {
        one *= 2.0;
      }
    }
  }
  for (std::size_t b = 0; b < bounds_.size(); ++b) {
    if (bounds_[b].time_s > 0.0 && share[static_cast<Index>(b)] >= loud) return whole;
  }
  return share;
}

/// For errors with correlation times of their own alone, then beside those of each correlation
/// time.
InstrumentNoise::Shares InstrumentNoise::find_shares() const {
  VectorXd all = VectorXd::Ones(static_cast<Index>(bounds_.size()));
  Shares shares;
  for (const double time : correlation_times) shares.push_back(find_share(all, time));
  for (std::size_t b = 0; b < bounds_.size(); ++b) {
    if (bounds_[b].time_s == 0.0) all[static_cast<Index>(b)] = 0.0;
  }
  shares.insert(shares.begin(), find_share(all, 0.0));
  return shares;
}

GaussMarkovFilter InstrumentNoise::filter(const VectorXd& shares, double time_s) const {
  std::vector<GaussMarkovState> states;
  for (const Source& source : sources_) {
    const ErrorBound& bound = bounds_[source.bound];
    const double size = shares[static_cast<Index>(source.bound)] * bound.size;
    if (!(size > 0.0)) continue;
    states.push_back({.variance = size * size,
                      .time = bound.time_s > 0.0 ? bound.time_s : time_s,
                      .slopes = &source.slopes});
  }
  VectorXd white(std::ssize(short_));
  for (Index j = 0; j < white.size(); ++j) {
    const ShortNoise& own = short_[static_cast<std::size_t>(j)];
    white[j] = own.white;
    if (own.variance > 0.0) {
      states.push_back({.variance = own.variance, .rows = own.rows, .output = j});
    }
  }
  return {states, white, times_};
}

InstrumentNoise::Noise InstrumentNoise::make_noise(const VectorXd& shares, double time_s) const {
  Noise noise{.filter = filter(shares, time_s)};
  const MatrixXd white = noise.whiten(known_);
  noise.basis = orthonormal_basis(white.leftCols(white.cols() - 1));
  noise.residual = remove_span(noise.basis, white.rightCols<1>());
  return noise;
}

void InstrumentNoise::set_beside(const Columns& columns) {
  const MatrixXd reduced = reduce(columns);
  MatrixXd all(known_.rows(), known_.cols() - 1 + reduced.cols());
  all << known_.leftCols(known_.cols() - 1), reduced;
  find_short_noise(remove_span(orthonormal_basis(std::move(all)), known_.rightCols<1>()));
  noises_ = make_noises({1.0, 0.5}, find_shares());
  for (Noise& noise : noises_) {
    noise.left = noise.left_beside(noise.explained_by(noise.whiten_beyond(reduced)));
  }
}

std::vector<InstrumentTail> InstrumentNoise::tails(const std::vector<Columns>& candidates) const {
  std::vector<InstrumentTail> found(candidates.size());
  Columns all;
  for (const Columns& candidate : candidates) all = join(all, candidate);
  const MatrixXd reduced = reduce(all);
  const auto averaged = static_cast<double>(rows_.stride);
  const auto for_each = [&](const auto& visit) {
    Index first = 0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const Index q = candidates[i].cols();
      if (q > 0) visit(found[i], first, q);
      first += q;
    }
  };
  for_each([&](InstrumentTail& tail, Index first, Index q) {
    const double seen = averaged * reduced.middleCols(first, q).squaredNorm();
    tail = {-infinity, infinity, seen / static_cast<double>(q)};
  });
  for (const Noise& noise : noises_) {
    const MatrixXd white = noise.whiten_beyond(reduced);
    for_each([&](InstrumentTail& tail, Index first, Index q) {
      const numerics::ExplainedSquares by = noise.explained_by(white.middleCols(first, q));
      const double left = noise.least_left(noise.left_beside(by));
      tail.log10_p = std::max(tail.log10_p, noise.log10_tail(by, left));
      tail.left = std::min(tail.left, left);
    });
  }
  return found;
}

bool InstrumentNoise::knows_the_noise() const {
  return std::ranges::any_of(noises_, [](const Noise& noise) { return noise.left < most_left; });
}

MatrixXd InstrumentNoise::reduce(const LinearisedFit& fit) const {
  const RowLayout& layout = fit.layout;
  const RowLayout& known = null_.fit().layout;
  if (layout.outputs.size() != known.outputs.size()) return {};
  MatrixXd columns(rows_.layout.count(), fit.tangent.cols() + 1);
  columns << rows_.apply(layout, view(fit.tangent)), rows_.apply(layout, view(fit.residual));
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    columns.middleRows(rows_.layout.first(j), rows_.layout.rows) *=
        layout.outputs[j].scale / known.outputs[j].scale;
  }
  return columns;
}

double InstrumentNoise::minus_two_log_likelihood(const LinearisedFit& fit) const {
  const MatrixXd columns = reduce(fit);
  if (columns.size() == 0) return -infinity;
  double least = infinity;
  for (const Noise& noise : noises_) {
    const double sum = noise.sum_left(columns) / noise.variance();
    least = std::min(least, sum + noise.filter.log_determinant());
  }
  return least;
}

InstrumentTail InstrumentNoise::tail_of_fit(const LinearisedFit& with, Index coefficients) const {
  const MatrixXd columns = reduce(with);
  if (columns.size() == 0) return {};
  InstrumentTail found{-infinity, infinity, 1.0};
  const auto q = static_cast<double>(coefficients);
  for (const Noise& noise : noises_) {
    const double freedom = noise.freedom_beside(coefficients);
    if (!(freedom > 0.0)) return {};
    const double sum = noise.sum_left(columns);
    const double left = noise.least_left(sum / freedom);
    const double explained = std::max(0.0, noise.residual.squaredNorm() - sum);
    const double F = explained / q / std::max(1.0, left);
    found.log10_p = std::max(found.log10_p, numerics::log10_f_tail(F, q, freedom));
    found.left = std::min(found.left, left);
  }
  return found;
}

double InstrumentNoise::excuse(const Columns& candidate, double log10_wanted, double least) const {
  constexpr int doublings = 6;
  const MatrixXd reduced = reduce(candidate);
  for (int doubled = 0; doubled <= doublings; ++doubled) {
    const double times = std::ldexp(least, doubled);
    for (const Noise& noise : make_noises({times}, whole())) {
      const numerics::ExplainedSquares by = noise.explained_by(noise.whiten_beyond(reduced));
      if (noise.log10_tail(by, noise.left_beside(by)) > log10_wanted) return times;
    }
  }
  return infinity;
}

VectorXd InstrumentNoise::sigmas(const Columns& columns) const {
  const MatrixXd reduced = reduce(columns);
  VectorXd least = VectorXd::Constant(reduced.cols(), infinity);
  for (const Noise& noise : noises_) {
    const MatrixXd white = noise.whiten_beyond(reduced);
    const VectorXd sizes = white.colwise().norm().transpose();
    least = least.cwiseMin(sizes / std::sqrt(noise.variance()));
  }
  return least;
}

}  // namespace sepcal::diagnosis
