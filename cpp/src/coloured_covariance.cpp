// SPDX-License-Identifier: BSD-3-Clause
#include "coloured_covariance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Where the rows of each segment stand in a matrix of the selected rows.
/// Schwarz's criterion: under white noise AIC would take chance for colour in one fit of six.
double criterion(double minus_two_log_likelihood, double parameters, Index rows) {
  return minus_two_log_likelihood + parameters * std::log(static_cast<double>(rows));
}

/// -2 ln L of white noise at its best sigma; with a free level, of the differences.
double white_likelihood(const VectorXd& e, const std::vector<Segment>& segments, bool free_level) {
  const Whitener whitener({.free_level = free_level}, segments);
  MatrixXd y = e;
  whitener.apply(y);
  const auto n = static_cast<double>(whitener.informative_rows());
  return n * (std::log(2.0 * std::numbers::pi * y.squaredNorm() / n) + 1.0) +
         whitener.log_determinant();
}

}  // namespace

std::optional<NoiseModel> find_residual_noise(std::span<const double> e,
                                              const std::vector<Segment>& segments) {
  constexpr Index fewest_rows = 30;
  const VectorXd rows = gather_rows(e, segments);
  const double square = rows.squaredNorm();
  if (rows.size() < fewest_rows || !(square > 0.0)) return std::nullopt;
  const NoiseFit fit = fit_noise(e, segments);
  NoiseModel white{.sigma = std::sqrt(square / static_cast<double>(rows.size()))};
  if (fit.model.d == 0.0 && fit.model.order() == 0) return white;
  const double coloured =
      criterion(fit.minus_two_log_likelihood, fit.model.order() + 2.0, fit.informative_rows);
  const double plain = criterion(white_likelihood(rows, segments, fit.model.level_is_free()), 1.0,
                                 fit.informative_rows);
  return coloured < plain ? fit.model : white;
}

MatrixXd find_coloured_covariance(const Sweep& sweep, const StageTwo& two,
                                  const std::vector<Index>& inside, const MatrixXd& R,
                                  const MatrixXd& white, bool noise_given) {
  const Index n_1 = sweep.tables().n_1();
  const Index n = two.x.size();
  const MatrixXd residuals = sweep.residuals(two.x.head(n_1), two.x.tail(n - n_1));
  const auto freedom = static_cast<double>(residuals.size() - n);
  if (inside.empty() || !(freedom > 0.0) || !white.allFinite() || !residuals.allFinite()) {
    return white;
  }
  const std::vector<Segment>& runs = sweep.measurements().runs();
  const auto outputs = static_cast<std::size_t>(residuals.cols());
  std::vector<std::optional<NoiseModel>> models(outputs);
  sweep.pool().for_each(outputs, [&](std::size_t j) {
    const auto e = residuals.col(static_cast<Index>(j));
    // An estimated R above its own residual stands at its floor: what is left is rounding.
    const double rms = e.norm() / std::sqrt(static_cast<double>(e.size()));
    if (!noise_given && rms < 0.99 * two.noise[static_cast<Index>(j)]) return;
    models[j] = find_residual_noise({e.data(), static_cast<std::size_t>(e.size())}, runs);
  });
  const bool all_white = std::ranges::all_of(models, [](const std::optional<NoiseModel>& model) {
    return !model || (model->d == 0.0 && model->order() == 0);
  });
  if (all_white && !noise_given) return white;

  std::vector<MatrixXd> tangents = sweep.tangent_rows(two.x.head(n_1), two.x.tail(n - n_1));
  const auto k = static_cast<Index>(inside.size());
  const double inflation = static_cast<double>(residuals.size()) / freedom;
  std::vector<MatrixXd> parts(outputs);
  sweep.pool().for_each(outputs, [&](std::size_t j) {
    const double noise = two.noise[static_cast<Index>(j)];
    MatrixXd Q = tangents[j](Eigen::all, inside) / noise;  // whitened; then its columns orthonormal
    tangents[j].resize(0, 0);
    R.triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(Q);
    if (models[j]) {
      models[j]->sigma /= noise;
      parts[j] = inflation * covariance_product(*models[j], runs, Q);
    } else {
      parts[j] = (noise_given ? 1.0 : inflation) * Q.transpose() * Q;
    }
  });
  MatrixXd middle = MatrixXd::Zero(k, k);
  for (const MatrixXd& part : parts) middle += part;
  const MatrixXd inverse = R.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(k, k));
  const MatrixXd covariance = inverse * middle * inverse.transpose();
  return covariance.allFinite() ? MatrixXd(0.5 * (covariance + covariance.transpose())) : white;
}

}  // namespace sepcal
