// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/noise_hypothesis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "numerics/decompositions.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::span<const double> rows_of(const RowLayout& layout, const VectorXd& values, std::size_t j) {
  return {values.data() + layout.first(j), static_cast<std::size_t>(layout.rows)};
}

}  // namespace

bool is_coloured(const NoiseModel& noise) {
  return noise.d > 0.2 || (noise.phi.size() > 0 && noise.phi.cwiseAbs().maxCoeff() > 0.3);
}

double noise_floor(const RowLayout& layout, const NoiseModels& noise) {
  double square = 0.0;
  for (std::size_t j = 0; j < noise.size(); ++j) {
    const double sigma = noise[j].sigma * layout.outputs[j].scale;
    square += sigma * sigma;
  }
  return std::sqrt(square / static_cast<double>(noise.size()));
}

NoiseModels fit_noise_models(const RowLayout& layout, const VectorXd& residual) {
  // A long autoregression of a short record learns a slow effect by heart.
  constexpr Index rows_a_coefficient = 200;
  const auto order = static_cast<int>(std::clamp<Index>(layout.rows / rows_a_coefficient, 1, 8));
  NoiseModels noise;
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    noise.push_back(
        fit_noise(rows_of(layout, residual, j), layout.runs, {.max_order = order}).model);
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
    Whitener(noise[j], layout.runs).apply(columns.middleRows(layout.first(j), layout.rows));
  }
}

MatrixXd pseudo_inverse(const MatrixXd& square) {
  constexpr double undetermined = 1e-10;  // of the largest eigenvalue
  if (square.size() == 0) return square;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(square);
  const VectorXd& values = solver.eigenvalues();
  const double least = undetermined * values.tail<1>().value();
  const VectorXd inverse =
      values.unaryExpr([least](double value) { return value > least ? 1.0 / value : 0.0; });
  return solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
}

WhitenedColumns::WhitenedColumns(const RowLayout& layout, const MatrixXd& columns,
                                 const NoiseModels& noise)
    : layout_(layout), noise_(noise), columns_(columns), white_(columns) {
  whiten(layout, noise, white_);
  covariance_ = pseudo_inverse(white_.transpose() * white_);
}

VectorXd WhitenedColumns::estimate(const VectorXd& residual) const {
  MatrixXd white = residual;
  whiten(layout_, noise_, white);
  return covariance_ * (white_.transpose() * white.col(0));
}

Hypothesis WhitenedColumns::step(const VectorXd& residual, double least_gain, bool afresh) const {
  Hypothesis at{.noise = noise_, .coefficients = estimate(residual)};
  const VectorXd left = residual - columns_ * at.coefficients;
  for (std::size_t j = 0; j < layout_.outputs.size(); ++j) {
    // A search from noise that has nearly swallowed the residual may end in a poor optimum.
    std::vector<NoiseModel> starts{noise_[j]};
    if (afresh && is_coloured(noise_[j])) starts.push_back(forget_colour({noise_[j]}).front());
    double least = std::numeric_limits<double>::infinity();
    for (const NoiseModel& start : starts) {
      const NoiseFit fit = fit_noise(rows_of(layout_, left, j), layout_.runs,
                                     {.start = start, .least_gain = least_gain});
      if (!(fit.minus_two_log_likelihood < least)) continue;
      least = fit.minus_two_log_likelihood;
      at.noise[j] = fit.model;
      at.noise[j].sigma = std::max(fit.model.sigma, least_sigma);
    }
    at.minus_two_log_likelihood += least;
  }
  return at;
}

Hypothesis maximise(const RowLayout& layout, const MatrixXd& columns, const VectorXd& residual,
                    const std::vector<NoiseModels>& starts) {
  constexpr int most_rounds = 3;
  constexpr double least_gain = 0.02;  // in -2 ln L, of a round
  constexpr double precise = 1e-3;     // of the search for the noise model
  Hypothesis best;
  best.minus_two_log_likelihood = std::numeric_limits<double>::infinity();
  for (const NoiseModels& start : starts) {
    NoiseModels noise = start;
    double last = std::numeric_limits<double>::infinity();
    for (int round = 0; round < most_rounds; ++round) {
      const WhitenedColumns whitened(layout, columns, noise);
      Hypothesis at = whitened.step(residual, precise, round == 0);
      noise = at.noise;
      const double gain = last - at.minus_two_log_likelihood;
      last = at.minus_two_log_likelihood;
      if (last < best.minus_two_log_likelihood) {
        best = std::move(at);
        best.covariance = whitened.covariance();
      }
      if (gain < least_gain) break;
    }
  }
  return best;
}

}  // namespace sepcal::diagnosis
