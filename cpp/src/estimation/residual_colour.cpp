// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/residual_colour.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

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

bool is_white(const NoiseModel& noise) { return noise.d == 0.0 && noise.order() == 0; }

std::optional<NoiseModel> find_residual_noise(std::span<const double> e,
                                              const std::vector<Segment>& segments) {
  constexpr Index fewest_rows = 30;
  const VectorXd rows = gather_rows(e, segments);
  const double square = rows.squaredNorm();
  if (rows.size() < fewest_rows || !(square > 0.0)) return std::nullopt;
  const NoiseFit fit = fit_noise(e, segments);
  NoiseModel white{.sigma = std::sqrt(square / static_cast<double>(rows.size()))};
  if (is_white(fit.model)) return white;
  const double coloured =
      criterion(fit.minus_two_log_likelihood, fit.model.order() + 2.0, fit.informative_rows);
  const double plain = criterion(white_likelihood(rows, segments, fit.model.level_is_free()), 1.0,
                                 fit.informative_rows);
  return coloured < plain ? fit.model : white;
}

std::vector<std::optional<NoiseModel>> find_output_noise(const MatrixXd& residuals,
                                                         const std::vector<Segment>& runs,
                                                         const VectorXd& rounding,
                                                         base::ThreadPool& pool) {
  std::vector<std::optional<NoiseModel>> models(static_cast<std::size_t>(residuals.cols()));
  pool.for_each(models.size(), [&](std::size_t j) {
    const auto e = residuals.col(static_cast<Index>(j));
    const double rms = e.norm() / std::sqrt(static_cast<double>(e.size()));
    if (rms < rounding[static_cast<Index>(j)]) return;
    models[j] = find_residual_noise({e.data(), static_cast<std::size_t>(e.size())}, runs);
  });
  return models;
}

MatrixXd find_score_covariance(std::vector<MatrixXd> tangents, const ScoreNoise& noise,
                               const std::vector<Index>& columns, const MatrixXd& K,
                               base::ThreadPool& pool) {
  std::vector<MatrixXd> parts(tangents.size());
  pool.for_each(parts.size(), [&](std::size_t j) {
    const double deviation = noise.deviations[static_cast<Index>(j)];
    MatrixXd Q = tangents[j](Eigen::all, columns) / deviation;  // whitened, then in K's coordinates
    tangents[j].resize(0, 0);
    K.triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(Q);
    if (std::optional<NoiseModel> model = noise.models[j]) {
      model->sigma /= deviation;
      parts[j] = noise.inflation * covariance_product(*model, noise.runs, Q);
    } else {
      parts[j] = Q.transpose() * Q;
    }
  });
  MatrixXd sum = MatrixXd::Zero(K.cols(), K.cols());
  for (const MatrixXd& part : parts) sum += part;
  return sum;
}

}  // namespace sepcal::estimation
