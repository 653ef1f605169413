// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/residual_curves.hpp"

#include <unsupported/Eigen/FFT>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "numerics/decompositions.hpp"
#include "numerics/order_statistics.hpp"
#include "numerics/quantiles.hpp"
#include "numerics/toeplitz.hpp"
#include "sepcal/detail/quantity.hpp"

namespace sepcal::numerics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Index longest_of(const std::vector<Segment>& runs) {
  std::size_t longest = 0;
  for (const Segment& run : runs) longest = std::max(longest, run.rows());
  return static_cast<Index>(longest);
}

/// Whole lags from 1 to `furthest`, about evenly spaced on a logarithmic axis.
std::vector<Index> choose_lags(Index furthest) {
  constexpr int most = 160;
  std::vector<Index> lags;
  for (int i = 0; i < most; ++i) {
    const double at = std::pow(static_cast<double>(furthest), i / (most - 1.0));
    const auto lag = static_cast<Index>(at * (1 + 1e-12));  // rounding takes no lag down by one
    if (lags.empty() || lag > lags.back()) lags.push_back(lag);
  }
  return lags;
}

/// `count` + 1 edges whose ratios are one, from low to high.
std::vector<double> even_ratios(double low, double high, int count) {
  std::vector<double> edges;
  for (int i = 0; i <= count; ++i) {
    edges.push_back(low * std::pow(high / low, static_cast<double>(i) / count));
  }
  return edges;
}

/// Means of x and y between neighbouring edges where `fewest` points or more lie; the outer bins
/// take what lies beyond them.
Curve average_between(const std::vector<double>& edges, const VectorXd& x, const VectorXd& y,
                      int fewest) {
  const std::size_t bins = edges.size() - 1;
  VectorXd sum_x = VectorXd::Zero(static_cast<Index>(bins));
  VectorXd sum_y = sum_x;
  VectorXd count = sum_x;
  for (Index i = 0; i < x.size(); ++i) {
    const auto above = std::upper_bound(edges.begin() + 1, edges.end() - 1, x[i]);
    const Index bin = above - edges.begin() - 1;
    sum_x[bin] += x[i];
    sum_y[bin] += y[i];
    count[bin] += 1;
  }
  Curve means;
  for (Index bin = 0; bin < count.size(); ++bin) {
    if (count[bin] < fewest) continue;
    means.x.push_back(sum_x[bin] / count[bin]);
    means.y.push_back(sum_y[bin] / count[bin]);
  }
  return means;
}

/// Which of `points` even x, counted from `low` to `high`, have one of the given x within five.
std::vector<bool> find_near(const VectorXd& x, double low, double high, Index points) {
  constexpr Index reach = 5;
  std::vector<bool> near(static_cast<std::size_t>(points), false);
  for (const double value : x) {
    if (!std::isfinite(value)) continue;
    const double share = (value - low) / (high - low);
    const Index place = std::lround(share * static_cast<double>(points - 1));
    const Index last = std::min(points - 1, place + reach);
    for (Index i = std::max<Index>(0, place - reach); i <= last; ++i) {
      near[static_cast<std::size_t>(i)] = true;
    }
  }
  return near;
}

/// [1 | B], (N, smooth_knots): all natural splines on the knots of [0, 1].
MatrixXd smooth_basis(const VectorXd& x) {
  const SplineBasis spline(even_knots(0, 1, smooth_knots));
  MatrixXd basis(x.size(), smooth_knots);
  basis << VectorXd::Ones(x.size()), spline_columns(spline, x);
  return basis;
}

/// (B'B)^-1, without the directions that knots with no rows between them leave open.
MatrixXd inverse_of_gram(const MatrixXd& basis) {
  constexpr double open = 1e-10;  // of the largest eigenvalue
  const Eigen::SelfAdjointEigenSolver<MatrixXd> gram(basis.transpose() * basis);
  const VectorXd& values = gram.eigenvalues();
  const double least = open * values.maxCoeff();
  const VectorXd inverse =
      values.unaryExpr([least](double value) { return value > least ? 1 / value : 0.0; });
  return gram.eigenvectors() * inverse.asDiagonal() * gram.eigenvectors().transpose();
}

/// The autocovariance of `left` (N, its mean taken for zero), tapered to a quarter of the rows,
/// (N).
VectorXd tapered_autocovariance(const VectorXd& left) {
  const Index furthest = std::max<Index>(1, left.size() / 4);
  const VectorXd taper = VectorXd::LinSpaced(furthest + 2, 1, 0).head(furthest + 1);
  VectorXd covariance = VectorXd::Zero(left.size());
  covariance.head(furthest + 1) = autocovariance(left, furthest).cwiseProduct(taper);
  return covariance;
}

}  // namespace

Autocorrelation find_autocorrelation(const VectorXd& residual, const std::vector<Segment>& runs) {
  if (residual.size() == 0) return {};
  constexpr double reach = 1.96;  // standard deviations: 95 % of a normal distribution
  const VectorXd e = residual.array() - residual.mean();
  const double variance = e.squaredNorm() / static_cast<double>(e.size());
  Autocorrelation found;
  for (const Index lag : choose_lags(std::max<Index>(1, longest_of(runs) / 3))) {
    double sum = 0;
    double pairs = 0;
    for (const Segment& run : runs) {
      const Index rows = static_cast<Index>(run.rows()) - lag;
      if (rows <= 0) continue;
      const auto first = static_cast<Index>(run.first);
      sum += e.segment(first, rows).dot(e.segment(first + lag, rows));
      pairs += static_cast<double>(rows);
    }
    const bool varies = variance > 0;
    found.lags.push_back(static_cast<double>(lag));
    found.values.push_back(varies ? sum / pairs / variance : not_a_number);
    found.limits.push_back(varies ? reach / std::sqrt(pairs) : not_a_number);
  }
  return found;
}

Curve find_spectrum(const VectorXd& residual, const std::vector<Segment>& runs, double interval) {
  constexpr Index longest = 4096;
  constexpr int bins = 120;
  const Index length = std::min(longest, longest_of(runs));
  const Index inner = (length + 1) / 2 - 1;  // frequencies between zero and half the sampling's
  if (inner < 1) return {};
  const VectorXd turn = VectorXd::LinSpaced(length, 1, static_cast<double>(length)) *
                        (2 * std::numbers::pi / static_cast<double>(length + 1));
  const VectorXd window = 0.5 - 0.5 * turn.array().cos();
  const double mean = residual.mean();
  Eigen::FFT<double> fft;
  VectorXd windowed;
  Eigen::VectorXcd transformed;
  VectorXd power = VectorXd::Zero(inner);
  double windows = 0;
  for (const Segment& run : runs) {
    const auto last = static_cast<Index>(run.last);
    for (auto first = static_cast<Index>(run.first); first + length <= last; first += length / 2) {
      windowed = window.array() * (residual.segment(first, length).array() - mean);
      fft.fwd(transformed, windowed);
      power += transformed.segment(1, inner).cwiseAbs2();
      windows += 1;
    }
  }
  const VectorXd density = power * (2 * interval / (windows * window.squaredNorm()));
  const VectorXd frequency = VectorXd::LinSpaced(inner, 1, static_cast<double>(inner)) /
                             (static_cast<double>(length) * interval);
  const double low = frequency[0];
  const double high = frequency[inner - 1] * (1 + 1e-12);
  return average_between(even_ratios(low, high, bins), frequency, density, 1);
}

Curve find_quantiles(const VectorXd& residual) {
  constexpr std::size_t most = 200;
  std::vector<double> values(residual.begin(), residual.end());
  std::ranges::sort(values);
  const std::size_t size = std::min(most, values.size());
  const double least = 0.5 / static_cast<double>(values.size());
  Curve found;
  for (std::size_t i = 0; i < size; ++i) {
    const double turn = (static_cast<double>(i) + 0.5) / static_cast<double>(size);
    const double share =
        std::clamp(0.5 * (1 - std::cos(std::numbers::pi * turn)), least, 1 - least);
    found.x.push_back(normal_quantile(share));
    found.y.push_back(quantile(values, share));
  }
  return found;
}

Curve bin_means(const VectorXd& x, const VectorXd& y, int bins) {
  constexpr int fewest = 5;
  if (x.size() == 0) return {};
  const VectorXd edges = VectorXd::LinSpaced(bins + 1, x.minCoeff(), x.maxCoeff());
  return average_between({edges.begin(), edges.end()}, x, y, fewest);
}

MatrixXd spline_columns(const SplineBasis& spline, const VectorXd& x) {
  MatrixXd columns(x.size(), spline.functions());
  Eigen::RowVectorXd values(spline.functions());
  for (Index row = 0; row < x.size(); ++row) {
    spline.evaluate(x[row], values);
    columns.row(row) = values;
  }
  return columns;
}

std::optional<Smooth> fit_smooth(const VectorXd& x, const VectorXd& y) {
  constexpr Index points = 80;
  const Eigen::ArrayXd there = (x + y).array().isFinite().cast<double>();
  const VectorXd known = (there > 0).select(x, not_a_number);
  if (!(there > 0).any()) return std::nullopt;
  const double low = known.minCoeff<Eigen::PropagateNumbers>();
  const double high = known.maxCoeff<Eigen::PropagateNumbers>();
  if (!(high > low)) return std::nullopt;
  const VectorXd within = (there > 0).select((known.array() - low) / (high - low), 0.0);
  const MatrixXd basis = there.matrix().asDiagonal() * smooth_basis(within);
  const VectorXd given = (there > 0).select(y, 0.0);
  const MatrixXd weights = basis * inverse_of_gram(basis);  // (N, smooth_knots)
  const VectorXd coefficients = weights.transpose() * given;
  const VectorXd left = given - basis * coefficients;
  const MatrixXd covariance =
      weights.transpose() * multiply_toeplitz(tapered_autocovariance(left), weights);
  const VectorXd at = VectorXd::LinSpaced(points, 0, 1);
  const MatrixXd drawn = smooth_basis(at);
  Smooth smooth{
      (low + (high - low) * at.array()).matrix(), drawn * coefficients,
      2 * (drawn * covariance).cwiseProduct(drawn).rowwise().sum().cwiseMax(0).cwiseSqrt()};
  const std::vector<bool> near = find_near(known, low, high, points);
  for (Index i = 0; i < points; ++i) {
    if (!near[static_cast<std::size_t>(i)]) smooth.mean[i] = smooth.half_width[i] = not_a_number;
  }
  return smooth;
}

}  // namespace sepcal::numerics
