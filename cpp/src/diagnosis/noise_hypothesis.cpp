// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/noise_hypothesis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "numerics/decompositions.hpp"
#include "numerics/tall_products.hpp"

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
    const double sigma = noise[j].sigma * layout.outputs[j].weight;
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

MatrixXd white_products(const RowLayout& layout, const Columns& X, const VectorXd& e,
                        const std::function<void(std::size_t, Eigen::Ref<MatrixXd>)>& whiten) {
  constexpr Index most_at_once = 64;  // columns in memory
  const Columns both = join(X, view(e));
  const Index count = both.cols();
  const Index width = count <= most_at_once ? count : most_at_once / 2;
  const auto make = [&](std::size_t j, Index from) {
    MatrixXd white(layout.rows, std::min(width, count - from));
    if (white.cols() == count) {
      both.fill(layout.first(j), white);
    } else {
      for (Index row = 0; row < layout.rows; row += panel_rows) {
        const Index rows = std::min(panel_rows, layout.rows - row);
        white.middleRows(row, rows) =
            both.rows(layout.first(j) + row, rows).middleCols(from, white.cols());
      }
    }
    whiten(j, white);
    return white;
  };
  MatrixXd products = MatrixXd::Zero(count, count);
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    for (Index a = 0; a < count; a += width) {
      const MatrixXd left = make(j, a);
      numerics::add_square(left, products.block(a, a, left.cols(), left.cols()));
      for (Index b = a + width; b < count; b += width) {
        const MatrixXd right = make(j, b);
        numerics::add_transposed_product(left, right,
                                         products.block(a, b, left.cols(), right.cols()));
      }
    }
  }
  return products.selfadjointView<Eigen::Upper>();
}

MatrixXd products_beyond(const MatrixXd& products, Index known) {
  const Index others = products.cols() - known;
  const MatrixXd shares = products.topRightCorner(known, others);
  return products.bottomRightCorner(others, others) -
         shares.transpose() * pseudo_inverse(products.topLeftCorner(known, known)) * shares;
}

namespace {

/// Generalised least squares of a residual on columns in a noise, and the noise model of what that
/// leaves, of the same order; with `afresh` its search begins a second time without colour.
Hypothesis step(const RowLayout& layout, const Columns& columns, const VectorXd& residual,
                const NoiseModels& noise, bool afresh) {
  constexpr double precise = 1e-3;  // of the search, in -2 ln L
  const Index k = columns.cols();
  const MatrixXd products = white_products(layout, columns, residual,
                                           [&](std::size_t j, const Eigen::Ref<MatrixXd>& white) {
                                             Whitener(noise[j], layout.runs).apply(white);
                                           });
  Hypothesis at{.noise = noise, .covariance = pseudo_inverse(products.topLeftCorner(k, k))};
  at.coefficients = at.covariance * products.col(k).head(k);
  const VectorXd left = subtract(layout, residual, columns, at.coefficients);
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    // A search from noise that has nearly swallowed the residual may end in a poor optimum.
    std::vector<NoiseModel> starts{noise[j]};
    if (afresh && is_coloured(noise[j])) starts.push_back(forget_colour({noise[j]}).front());
    double least = std::numeric_limits<double>::infinity();
    for (const NoiseModel& start : starts) {
      const NoiseFit fit =
          fit_noise(rows_of(layout, left, j), layout.runs, {.start = start, .least_gain = precise});
      if (!(fit.minus_two_log_likelihood < least)) continue;
      least = fit.minus_two_log_likelihood;
      at.noise[j] = fit.model;
      at.noise[j].sigma = std::max(fit.model.sigma, least_sigma);
    }
    at.minus_two_log_likelihood += least;
  }
  return at;
}

}  // namespace

Hypothesis maximise(const RowLayout& layout, const Columns& columns, const VectorXd& residual,
                    const std::vector<NoiseModels>& starts) {
  constexpr int most_rounds = 3;
  constexpr double least_gain = 0.02;  // in -2 ln L, of a round
  Hypothesis best;
  best.minus_two_log_likelihood = std::numeric_limits<double>::infinity();
  for (const NoiseModels& start : starts) {
    NoiseModels noise = start;
    double last = std::numeric_limits<double>::infinity();
    for (int round = 0; round < most_rounds; ++round) {
      Hypothesis at = step(layout, columns, residual, noise, round == 0);
      noise = at.noise;
      const double gain = last - at.minus_two_log_likelihood;
      last = at.minus_two_log_likelihood;
      if (last < best.minus_two_log_likelihood) best = std::move(at);
      if (gain < least_gain) break;
    }
  }
  return best;
}

}  // namespace sepcal::diagnosis
