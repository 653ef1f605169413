// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/plausibility.hpp"

#include <cmath>

namespace sepcal::estimation {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd plausible_scale(const std::vector<Variable>& parameters,
                         const std::vector<TriangularFactor>& factors,
                         const model::Measurements& measurements) {
  double z_square = 0.0;
  for (std::size_t j = 0; j < factors.size(); ++j) {
    z_square += measurements.output_square(static_cast<int>(j));
  }
  return plausible_scale(parameters, factors, z_square);
}

VectorXd plausible_scale(const std::vector<Variable>& parameters,
                         const std::vector<TriangularFactor>& factors, double z_square) {
  const auto n = static_cast<Index>(parameters.size());
  VectorXd column_squares = VectorXd::Zero(n);
  for (const TriangularFactor& factor : factors) {
    column_squares += factor.matrix().leftCols(n).colwise().squaredNorm().transpose();
  }
  return plausible_scale(parameters, column_squares, z_square);
}

VectorXd plausible_scale(const std::vector<Variable>& parameters, const VectorXd& column_squares,
                         double z_square) {
  VectorXd scale(static_cast<Index>(parameters.size()));
  for (Index k = 0; k < scale.size(); ++k) {
    const Variable& parameter = parameters[static_cast<std::size_t>(k)];
    scale[k] = 0.5 * (parameter.upper - parameter.lower);
    if (std::isfinite(scale[k])) continue;
    scale[k] = std::sqrt(z_square / column_squares[k]);
  }
  return scale;
}

void Prior::join(TriangularFactor& factor, const VectorXd& x) const {
  const Index n = x.size();
  MatrixXd rows = MatrixXd::Zero(n, n + 1);
  rows.leftCols(n).diagonal() = weight;
  rows.col(n) = (mean - x).cwiseProduct(weight);
  factor.absorb(rows);
}

Prior loose_prior(const std::vector<Variable>& parameters, const VectorXd& scale) {
  constexpr double lengths = 10.0;
  Prior prior{VectorXd::Zero(scale.size()), VectorXd(scale.size())};
  for (Index k = 0; k < scale.size(); ++k) {
    const Variable& parameter = parameters[static_cast<std::size_t>(k)];
    const double middle = 0.5 * (parameter.lower + parameter.upper);
    if (std::isfinite(middle)) prior.mean[k] = middle;
    const bool known = std::isfinite(scale[k]) && scale[k] > 0;
    prior.weight[k] = 1.0 / (lengths * (known ? scale[k] : 1.0));
  }
  return prior;
}

}  // namespace sepcal::estimation
