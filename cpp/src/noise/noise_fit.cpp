// SPDX-License-Identifier: BSD-3-Clause
// -2 ln L = N ln(|W e|^2 / N) + ln det + N (1 + ln 2 pi), profiled over sigma, is N ln |y|^2 of
// y = W e det^{1/2N}: nonlinear least squares in d and the partial autocorrelations r of phi.
// Gauss & Newton refine them from the best order and d of a scan (noise_order.hpp).
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/stop.hpp"
#include "noise/arfima_factor.hpp"
#include "noise/noise_order.hpp"
#include "noise/noise_room.hpp"
#include "numerics/decompositions.hpp"
#include "sepcal/detail/quantity.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace noise;  // this room's own

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index fewest_rows = 8;               // differences, to fit anything but white noise
constexpr double free_from = 0.45;             // where little is lost with a segment's first row
constexpr double largest_stationary_d = 0.49;  // the variance is infinite at 0.5
constexpr double largest_d = 0.999;
constexpr double largest_partial = 0.9995;

/// y of the header, as a function of theta = (d, atanh r).
class Likelihood {
 public:
  explicit Likelihood(NoiseRows rows) : rows_(std::move(rows)) {}

  Index rows() const { return rows_.values.size(); }
  double square() const { return rows_.values.squaredNorm(); }
  double largest() const { return rows_.free_level ? largest_d : largest_stationary_d; }

  VectorXd clip(VectorXd theta) const {
    theta[0] = std::clamp(theta[0], 0.0, largest());
    const double most = std::atanh(largest_partial);
    for (Index k = 1; k < theta.size(); ++k) theta[k] = std::clamp(theta[k], -most, most);
    return theta;
  }

  /// Not a number where rounding takes phi out of what is stationary.
  VectorXd evaluate(const VectorXd& theta) const {
    base::heed_stop();
    if (!is_stationary(phi_of(theta))) return VectorXd::Constant(rows(), not_a_number);
    const ArfimaFactor factor = make_factor(theta);
    VectorXd y = rows_.values;
    factor.whiten(y, rows_.blocks);
    y *= std::exp(0.5 * mean_log_variance(factor));
    return y;
  }

  /// sigma^2 = |W e|^2 / N from |y|^2.
  double find_sigma(const VectorXd& theta, double square) const {
    return std::sqrt(square / static_cast<double>(rows())) *
           std::exp(-0.5 * mean_log_variance(make_factor(theta)));
  }

  static VectorXd phi_of(const VectorXd& theta) {
    return phi_from_partial(theta.tail(theta.size() - 1).array().tanh().matrix());
  }

 private:
  ArfimaFactor make_factor(const VectorXd& theta) const {
    return {theta[0] - (rows_.free_level ? 1.0 : 0.0), phi_of(theta), rows_.blocks};
  }

  /// ln det / N.
  double mean_log_variance(const ArfimaFactor& factor) const {
    return factor.log_determinant(rows_.blocks) / static_cast<double>(rows());
  }

  NoiseRows rows_;
};

struct Minimum {
  VectorXd theta;
  double square = 0.0;  // |y|^2
  int evaluations = 0;
  bool converged = false;
};

/// dy/dtheta by differences, inwards where d is at a bound.
MatrixXd differentiate(const Likelihood& likelihood, const VectorXd& theta, const VectorXd& y) {
  constexpr double step = 1e-5;
  MatrixXd slopes(y.size(), theta.size());
  for (Index k = 0; k < theta.size(); ++k) {
    VectorXd moved = theta;
    moved[k] += k == 0 && theta[0] + step > likelihood.largest() ? -step : step;
    slopes.col(k) = (likelihood.evaluate(moved) - y) / (moved[k] - theta[k]);
  }
  return slopes;
}

Minimum minimise(const Likelihood& likelihood, const VectorXd& start, double least_gain) {
  constexpr int most_steps = 30;
  const auto n = static_cast<double>(likelihood.rows());
  Minimum best{likelihood.clip(start)};
  VectorXd y = likelihood.evaluate(best.theta);
  best.evaluations = 1;
  // Nearly all predicted, the covariance of the first rows is lost in rounding: predict less.
  for (; !y.allFinite(); ++best.evaluations) {
    best.theta.tail(best.theta.size() - 1) *= 0.8;
    y = likelihood.evaluate(best.theta);
  }
  best.square = y.squaredNorm();
  double damping = 1e-6;
  for (int k = 0; k < most_steps; ++k) {
    const MatrixXd slopes = differentiate(likelihood, best.theta, y);
    best.evaluations += static_cast<int>(best.theta.size());
    MatrixXd H = slopes.transpose() * slopes;
    VectorXd gradient = slopes.transpose() * y;
    if (!gradient.allFinite()) return best;  // a difference reached what rounding loses
    // At a bound and drawn beyond it: the others move alone.
    const VectorXd inwards = likelihood.clip(best.theta - 1e-6 * gradient.cwiseSign());
    for (Index i = 0; i < gradient.size(); ++i) {
      if (gradient[i] == 0.0 || inwards[i] != best.theta[i]) continue;
      H.row(i).setZero();
      H.col(i).setZero();
      gradient[i] = 0.0;
    }
    // Where y hardly depends on a partial autocorrelation, its step stays small.
    H.diagonal().array() += 1e-12 * best.square;
    best.converged = n * gradient.dot(H.ldlt().solve(gradient)) < least_gain * best.square;
    if (best.converged) return best;
    bool fell = false;
    while (!fell && damping < 1e6) {
      MatrixXd damped = H;
      damped.diagonal() *= 1.0 + damping;
      const VectorXd theta = likelihood.clip(best.theta - damped.ldlt().solve(gradient));
      const VectorXd trial = likelihood.evaluate(theta);
      ++best.evaluations;
      fell = trial.squaredNorm() < best.square;  // false where it isn't finite
      damping = fell ? std::max(0.1 * damping, 1e-9) : 10.0 * damping;
      if (!fell) continue;
      best.theta = theta;
      best.square = trial.squaredNorm();
      y = trial;
    }
    if (!fell) return best;
  }
  return best;
}

/// theta of d and partial autocorrelations.
VectorXd pack(double d, const VectorXd& partial) {
  VectorXd theta(1 + partial.size());
  theta << d, partial.array().atanh().matrix();
  return theta;
}

NoiseFit fit_white(double square, Index rows) {
  const auto n = static_cast<double>(rows);
  NoiseFit fit;
  fit.model.sigma = std::sqrt(square / n);
  fit.minus_two_log_likelihood =
      n * (std::log(square / n) + 1.0 + std::log(2.0 * std::numbers::pi));
  fit.informative_rows = rows;
  return fit;
}

void check(const std::vector<Segment>& segments, const NoiseFitOptions& options) {
  if (segments.empty()) throw Error("there are no segments to fit the noise on; give at least one");
  if (options.order.value_or(0) < 0 || options.max_order < 0) {
    throw Error("the order of the noise model is negative; choose 0 or more");
  }
  if (options.start) check_noise_model(*options.start);
}

void check_finite(std::span<const double> e, const std::vector<Segment>& segments) {
  for (const Segment& segment : segments) {
    for (std::size_t row = segment.first; row < segment.last; ++row) {
      if (std::isfinite(e[row])) continue;
      throw Error("the residual at row " + std::to_string(row) +
                  " is not finite; leave that row out of the segments");
    }
  }
}

/// A minimum found from a scanned order; both orders are judged by the differences, which have a
/// distribution either way.
struct Start {
  VectorXd theta;
  int evaluations = 0;
};

Start find_start(const Likelihood& differences, const VectorXd& rows,
                 const std::vector<Index>& lengths, const NoiseFitOptions& options) {
  const auto judge = [&](double square, const NoiseOrder& order) {
    return static_cast<double>(differences.rows()) * std::log(square) +
           penalise(order.partial.size(), differences.rows());
  };
  auto orders = choose_noise_orders(rows, lengths, options);
  std::array<double, 2> first{};
  for (std::size_t k = 0; k < 2; ++k) {
    const VectorXd start = differences.clip(pack(orders[k].d, orders[k].partial));
    first[k] = judge(differences.evaluate(start).squaredNorm(), orders[k]);
  }
  if (first[1] < first[0]) {
    std::swap(first[0], first[1]);
    std::swap(orders[0], orders[1]);
  }
  constexpr double hopeless = 20.0;  // in AIC: more than refining a scanned start gains
  Start found;
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 2; ++k) {
    if (first[k] > lowest + hopeless) continue;
    const Minimum fitted =
        minimise(differences, pack(orders[k].d, orders[k].partial), options.least_gain);
    found.evaluations += fitted.evaluations;
    const double criterion = judge(fitted.square, orders[k]);
    if (found.theta.size() > 0 && !(criterion < lowest)) continue;
    lowest = criterion;
    found.theta = fitted.theta;
  }
  return found;
}

/// Of rows whose largest is 1.
NoiseFit fit_scaled(const VectorXd& rows, const std::vector<Index>& lengths,
                    const NoiseFitOptions& options) {
  const Likelihood differences(NoiseRows(rows, lengths, true));
  if (differences.rows() < fewest_rows || !(differences.square() > 0.0)) {
    return fit_white(rows.squaredNorm(), rows.size());
  }
  const Start start = options.start
                          ? Start{pack(options.start->d, partial_from_phi(options.start->phi))}
                          : find_start(differences, rows, lengths, options);
  const bool free_level =
      options.start ? options.start->level_is_free() : start.theta[0] >= free_from;
  const Likelihood likelihood(NoiseRows(rows, lengths, free_level));
  const Minimum best = minimise(likelihood, start.theta, options.least_gain);
  NoiseFit fit;
  fit.model.d = best.theta[0];
  fit.model.phi = Likelihood::phi_of(best.theta);
  fit.model.free_level = free_level;
  fit.model.sigma = likelihood.find_sigma(best.theta, best.square);
  const auto informative = static_cast<double>(likelihood.rows());
  fit.minus_two_log_likelihood =
      informative * (std::log(best.square / informative) + 1.0 + std::log(2.0 * std::numbers::pi));
  fit.informative_rows = likelihood.rows();
  fit.evaluations = start.evaluations + best.evaluations;
  fit.converged = best.converged;
  return fit;
}

}  // namespace

NoiseFit fit_noise(std::span<const double> e, const std::vector<Segment>& segments,
                   const NoiseFitOptions& options) {
  check(segments, options);
  VectorXd rows = gather_rows(e, segments);
  check_finite(e, segments);
  const double scale = rows.cwiseAbs().maxCoeff();
  if (!(scale > 0.0)) return fit_white(0.0, rows.size());
  rows /= scale;  // no square under- or overflows
  NoiseFit fit = fit_scaled(rows, find_lengths(segments), options);
  fit.model.sigma *= scale;
  fit.minus_two_log_likelihood += 2.0 * static_cast<double>(fit.informative_rows) * std::log(scale);
  return fit;
}

}  // namespace sepcal
