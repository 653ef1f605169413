// SPDX-License-Identifier: BSD-3-Clause
#include "residual_colour.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sepcal {
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

}  // namespace sepcal
