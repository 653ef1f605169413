// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/noise_hypothesis.hpp"

#include <Eigen/Cholesky>
#include <limits>
#include <span>

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::span<const double> rows_of(const RowLayout& layout, const VectorXd& values, std::size_t j) {
  return {values.data() + layout.first(j), static_cast<std::size_t>(layout.rows)};
}

/// The coefficients by generalised least squares, with their covariance.
void solve(const RowLayout& layout, const MatrixXd& columns, const VectorXd& residual,
           Hypothesis& at) {
  MatrixXd white(columns.rows(), columns.cols() + 1);
  white << columns, residual;
  whiten(layout, at.noise, white);
  const Index n = columns.cols();
  const MatrixXd square = white.leftCols(n).transpose() * white.leftCols(n);
  const VectorXd product = white.leftCols(n).transpose() * white.col(n);
  const Eigen::LDLT<MatrixXd> factor(square);
  at.coefficients = factor.solve(product);
  at.covariance = factor.solve(MatrixXd::Identity(n, n));
}

}  // namespace

NoiseModels fit_noise_models(const RowLayout& layout, const VectorXd& residual) {
  NoiseModels noise;
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    noise.push_back(fit_noise(rows_of(layout, residual, j), layout.segments).model);
  }
  return noise;
}

NoiseModels forget_colour(NoiseModels noise) {
  for (NoiseModel& model : noise) {
    model.free_level = model.level_is_free();
    model.d = 0.05;
    model.phi.setZero();
  }
  return noise;
}

void whiten(const RowLayout& layout, const NoiseModels& noise, MatrixXd& columns) {
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    Whitener(noise[j], layout.segments).apply(columns.middleRows(layout.first(j), layout.rows));
  }
}

Hypothesis maximise(const RowLayout& layout, const MatrixXd& columns, const VectorXd& residual,
                    const std::vector<NoiseModels>& starts, const Effort& effort) {
  constexpr double least_gain = 0.02;  // in -2 ln L
  Hypothesis best;
  best.minus_two_log_likelihood = std::numeric_limits<double>::infinity();
  for (const NoiseModels& start : starts) {
    NoiseModels noise = start;
    double last = std::numeric_limits<double>::infinity();
    for (int round = 0; round < effort.rounds; ++round) {
      Hypothesis at{.noise = noise};
      solve(layout, columns, residual, at);
      const VectorXd left = residual - columns * at.coefficients;
      for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
        const NoiseFit fit = fit_noise(rows_of(layout, left, j), layout.segments,
                                       {.start = noise[j], .least_gain = effort.least_gain});
        at.noise[j] = fit.model;
        at.minus_two_log_likelihood += fit.minus_two_log_likelihood;
      }
      noise = at.noise;
      const double gain = last - at.minus_two_log_likelihood;
      last = at.minus_two_log_likelihood;
      if (last < best.minus_two_log_likelihood) best = std::move(at);
      if (gain < least_gain) break;
    }
  }
  return best;
}

}  // namespace sepcal
