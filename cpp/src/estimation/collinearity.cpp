// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/collinearity.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "estimation/collinear_directions.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace estimation;  // this room's own

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Parameters whose row of the correlation says something.
std::vector<Index> known_estimates(const Fit& fit) {
  std::vector<Index> known;
  if (fit.correlation.rows() != static_cast<Index>(fit.parameters.size())) return known;
  for (Index k = 0; k < fit.correlation.rows(); ++k) {
    if (std::isfinite(fit.correlation(k, k))) known.push_back(k);
  }
  return known;
}

std::vector<CorrelatedPair> correlated_pairs(const std::vector<std::string>& names,
                                             const MatrixXd& C) {
  constexpr double strong = 0.9;
  std::vector<CorrelatedPair> pairs;
  for (Index i = 0; i < C.rows(); ++i) {
    for (Index j = i + 1; j < C.rows(); ++j) {
      if (!(std::abs(C(i, j)) > strong)) continue;
      pairs.push_back(
          {names[static_cast<std::size_t>(i)], names[static_cast<std::size_t>(j)], C(i, j)});
    }
  }
  std::ranges::stable_sort(pairs, std::ranges::greater{},
                           [](const CorrelatedPair& one) { return std::abs(one.correlation); });
  return pairs;
}

/// The directions of the scaled information M = V S^2 V'.
void find_directions(const MatrixXd& C, Collinearity& result) {
  const Index k = C.rows();
  result.condition_indices = VectorXd::Constant(k, infinity);
  result.variance_proportions = MatrixXd::Constant(k, k, not_a_number);
  const Eigen::LLT<MatrixXd> factor(C);
  if (k == 0 || factor.info() != Eigen::Success) return;
  const MatrixXd information = factor.solve(MatrixXd::Identity(k, k));
  const VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> directions(scale.asDiagonal() * information *
                                                           scale.asDiagonal());
  if (directions.info() != Eigen::Success || !(directions.eigenvalues()[0] > 0.0)) return;
  const VectorXd squares = directions.eigenvalues().reverse();
  result.condition_indices = (squares[0] / squares.array()).sqrt();
  const MatrixXd V = directions.eigenvectors().rowwise().reverse();
  const MatrixXd phi = squares.cwiseInverse().asDiagonal() * V.cwiseAbs2().transpose();
  result.variance_proportions = phi * phi.colwise().sum().cwiseInverse().transpose().asDiagonal();
}

/// Its place among the parameters.
Index place_of(const Fit& fit, const std::string& name) {
  const auto found = std::ranges::find(fit.parameters, name, &Parameter::name);
  if (found == fit.parameters.end()) static_cast<void>(fit[name]);  // throws
  const Index place = found - fit.parameters.begin();
  if (fit.covariance.rows() <= place || !std::isfinite(fit.covariance(place, place))) {
    throw Error(fmt::format("'{}' has no standard error, and so no ellipse; choose another", name));
  }
  return place;
}

}  // namespace

Collinearity find_collinearity(const Fit& fit) {
  Collinearity result;
  const std::vector<Index> known = known_estimates(fit);
  for (const Index k : known) {
    result.names.push_back(fit.parameters[static_cast<std::size_t>(k)].name);
  }
  const MatrixXd C = fit.correlation(known, known);
  result.pairs = correlated_pairs(result.names, C);
  find_directions(C, result);
  return result;
}

std::vector<CollinearDirection> estimation::collinear_directions(const Collinearity& found) {
  constexpr double worth_naming = 10.0;
  std::vector<CollinearDirection> directions;
  for (Index i = found.condition_indices.size(); i-- > 0;) {
    const double index = found.condition_indices[i];
    if (!(index > worth_naming) || std::isnan(found.variance_proportions(i, 0))) continue;
    CollinearDirection one{.condition_index = index, .proportions = {}};
    for (std::size_t k = 0; k < found.names.size(); ++k) {
      one.proportions.push_back(
          {found.names[k], found.variance_proportions(i, static_cast<Index>(k))});
    }
    directions.push_back(std::move(one));
  }
  return directions;
}

MatrixXd confidence_ellipse(const Fit& fit, const std::string& first, const std::string& second,
                            double level, int points) {
  if (!(level > 0.0 && level < 1.0)) {
    throw Error(fmt::format("level is {:g}; it lies between 0 and 1, as 0.95 does", level));
  }
  if (points < 4) throw Error(fmt::format("points is {}; an ellipse needs four or more", points));
  const std::vector<Index> places{place_of(fit, first), place_of(fit, second)};
  if (places[0] == places[1]) {
    throw Error(fmt::format("'{}' is named twice; an ellipse is of two parameters", first));
  }
  const MatrixXd P = fit.covariance(places, places);
  // Of chi-squared with two degrees of freedom, whose tail is exp(-x/2).
  const double reach = std::sqrt(-2.0 * std::log1p(-level));
  const double across = std::sqrt(std::max(0.0, P(1, 1) - P(0, 1) * P(0, 1) / P(0, 0)));
  const VectorXd estimates = fit.values();
  MatrixXd ellipse(points, 2);
  for (Index i = 0; i < points; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i % (points - 1)) /
                         static_cast<double>(points - 1);
    const double along = std::cos(angle) / std::sqrt(P(0, 0));  // by Cholesky's factor of P
    ellipse(i, 0) = estimates[places[0]] + reach * along * P(0, 0);
    ellipse(i, 1) = estimates[places[1]] + reach * (along * P(0, 1) + across * std::sin(angle));
  }
  return ellipse;
}

}  // namespace sepcal
