// SPDX-License-Identifier: BSD-3-Clause
#include "noise/gauss_markov_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "noise/noise_room.hpp"
#include "numerics/decompositions.hpp"
#include "sepcal/detail/quantity.hpp"

namespace sepcal::noise {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Restricted restrict(const MatrixXd& gram, Index rows, double log_determinant) {
  const Index p = gram.cols() - 1;
  const Eigen::LLT<MatrixXd> factor(gram);
  const VectorXd diagonal = factor.matrixLLT().diagonal();
  const auto n = static_cast<double>(rows - p);
  if (factor.info() != Eigen::Success || !(diagonal[p] > 0.0)) return {};
  const double variance = diagonal[p] * diagonal[p] / n;
  return {n * std::log(variance) + log_determinant + 2.0 * diagonal.head(p).array().log().sum(),
          std::sqrt(variance), gram};
}

/// The restricted likelihood of Gauss-Markov noise of unit variance, by a Kalman filter over all
/// columns at once.
class Filter {
 public:
  Filter(const MatrixXd& columns, const std::vector<Segment>& runs)
      : columns_(columns), white_(columns.rows(), columns.cols()), lengths_(find_lengths(runs)) {}

  Restricted evaluate(const GaussMarkovNoise& noise) {
    const double a = std::exp(-1.0 / noise.rows);
    const double gauss_markov = 1.0 - noise.white;
    ArrayXd state(columns_.cols());
    ArrayXd innovation(columns_.cols());
    constexpr double settled = 1e-15;
    double log_determinant = 0.0;
    Index t = 0;
    for (const Index length : lengths_) {
      state.setZero();
      double P = gauss_markov;  // variance of g as predicted
      double F = 0.0;
      double gain = 0.0;
      double precision = 0.0;
      bool moves = true;
      for (const Index last = t + length; t < last; ++t) {
        if (moves) {
          F = P + noise.white;
          gain = a * P / F;
          precision = 1.0 / std::sqrt(F);
          const double next = a * a * P * noise.white / F + gauss_markov * (1.0 - a * a);
          moves = std::abs(next - P) > settled * P;
          log_determinant += std::log(F) * (moves ? 1.0 : static_cast<double>(last - t));
          P = next;
        }
        innovation = columns_.row(t).transpose().array() - state;
        white_.row(t) = innovation.matrix().transpose() * precision;
        state = a * state + gain * innovation;
      }
    }
    return restrict(white_.transpose() * white_, columns_.rows(), log_determinant);
  }

 private:
  Rows columns_;
  Rows white_;
  std::vector<Index> lengths_;
};

/// Of ln(rows) and the logit of the white share.
using Point = std::array<double, 2>;

GaussMarkovNoise noise_at(const Point& point) {
  return {.rows = std::exp(point[0]), .white = 1.0 / (1.0 + std::exp(-point[1])), .sigma = 1.0};
}

/// Where the search of a record's noise begins.
std::vector<Point> grid(Index rows) {
  constexpr double apart = 2.0 * std::numbers::ln2;  // times, in their logarithm
  std::vector<Point> points;
  for (int i = 0; i * apart < std::log(static_cast<double>(rows)); ++i) {
    for (const double logit : {-4.0, 0.0, 3.0}) points.push_back({i * apart, logit});
  }
  return points;
}

}  // namespace

double scan_gauss_markov(const MatrixXd& columns, const std::vector<Segment>& runs) {
  Filter filter(columns, runs);
  double lowest = infinity;
  for (const Point& point : grid(columns.rows())) {
    lowest = std::min(lowest, filter.evaluate(noise_at(point)).minus_two_log_likelihood);
  }
  return lowest;
}

MatrixXd covariance_product(const GaussMarkovNoise& noise, const std::vector<Segment>& runs,
                            const Ref<const MatrixXd>& X) {
  const double a = std::exp(-1.0 / noise.rows);
  MatrixXd before = MatrixXd::Zero(X.rows(), X.cols());  // sum_{s<t} a^(t-s) x_s
  Index first = 0;
  for (const Index length : find_lengths(runs)) {
    for (Index t = first + 1; t < first + length; ++t) {
      before.row(t) = a * (before.row(t - 1) + X.row(t - 1));
    }
    first += length;
  }
  const MatrixXd crossed = (1.0 - noise.white) * (X.transpose() * before);
  return noise.sigma * noise.sigma * (X.transpose() * X + crossed + crossed.transpose());
}

double excess_explained(const Restricted& restricted, const MatrixXd& covariance, Index rows) {
  const Index k = covariance.cols();
  const auto G = restricted.gram.topLeftCorner(k, k);
  const VectorXd b = restricted.gram.col(k).head(k);
  const double explained = b.dot(G.llt().solve(b));
  const double left = (restricted.gram(k, k) - explained) / static_cast<double>(rows - k);
  // Of generalised less ordinary least squares, in the metric of the first: tr(G X'SX) - k.
  return explained / (left * G.cwiseProduct(covariance).sum());
}

GaussMarkovFit fit_gauss_markov(const MatrixXd& columns, const std::vector<Segment>& runs) {
  constexpr double least_step = 0.06;  // of ln(rows): less moves a standard error by 3 %
  // A memory longer than the record can't be told from one as long.
  const double longest = std::log(static_cast<double>(columns.rows()));
  const double shortest = std::log(0.3);
  constexpr double widest = 9.0;  // of the logit
  Filter filter(columns, runs);
  Point best{};
  Restricted lowest;
  const auto try_point = [&](Point point) {
    point[0] = std::clamp(point[0], shortest, longest);
    point[1] = std::clamp(point[1], -widest, widest);
    Restricted tried = filter.evaluate(noise_at(point));
    if (!(tried.minus_two_log_likelihood < lowest.minus_two_log_likelihood)) return false;
    lowest = std::move(tried);
    best = point;
    return true;
  };
  for (const Point& point : grid(columns.rows())) try_point(point);
  for (Point step{std::numbers::ln2, 1.0}; step[0] > least_step;) {
    bool found = false;
    for (const Point& way : {Point{1, 0}, Point{-1, 0}, Point{0, 1}, Point{0, -1}}) {
      const Point from = best;
      found = try_point({from[0] + way[0] * step[0], from[1] + way[1] * step[1]}) || found;
    }
    if (!found) step = {0.5 * step[0], 0.5 * step[1]};
  }
  GaussMarkovFit fit{noise_at(best), std::move(lowest)};
  fit.noise.sigma = fit.restricted.sigma;
  return fit;
}

GaussMarkovFit fit_white_rows(const MatrixXd& columns) {
  Restricted white = restrict(columns.transpose() * columns, columns.rows(), 0.0);
  const double sigma = white.sigma;
  return {{.rows = 1.0, .white = 1.0, .sigma = sigma}, std::move(white)};
}

Restricted restricted_likelihood(const MatrixXd& columns, const std::vector<Segment>& runs,
                                 NoiseModel& model) {
  model.sigma = 1.0;
  const Whitener whitener(model, runs);
  MatrixXd white = columns;
  whitener.apply(white);
  Restricted restricted =
      restrict(white.transpose() * white, whitener.informative_rows(), whitener.log_determinant());
  model.sigma = restricted.sigma;
  if (model.level_is_free()) {  // the differences' covariance: that of their sums is not so scaled
    for (const Segment& run : runs) {
      restricted.minus_two_log_likelihood -= std::log(static_cast<double>(run.rows()));
    }
  }
  return restricted;
}

}  // namespace sepcal::noise
