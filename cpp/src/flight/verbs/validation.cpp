// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/validation.hpp"

#include <cmath>

namespace sepcal::verbs {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

double root_mean_square(const VectorXd& x) {
  return x.norm() / std::sqrt(static_cast<double>(x.size()));
}

OutputValidation validate(const std::string& name, const VectorXd& y, const VectorXd& r) {
  OutputValidation result{.output = name};
  const VectorXd z = y + r;
  const VectorXd z_about = z.array() - z.mean();
  const VectorXd y_about = y.array() - y.mean();
  constexpr double rounding = 1e-12;  // of the output's size: it doesn't move
  if (!(root_mean_square(z_about) > rounding * root_mean_square(z))) return result;
  result.r_squared = 1.0 - r.squaredNorm() / z_about.squaredNorm();
  result.theil = root_mean_square(r) / (root_mean_square(z) + root_mean_square(y));
  const double square = r.squaredNorm() / static_cast<double>(r.size());
  if (!(square > 0.0)) return result;
  const double spread = root_mean_square(z_about) - root_mean_square(y_about);
  result.theil_bias = std::pow(r.mean(), 2) / square;
  result.theil_variance = spread * spread / square;
  const double common = z_about.dot(y_about) / static_cast<double>(r.size());
  result.theil_covariance =
      2.0 * (root_mean_square(z_about) * root_mean_square(y_about) - common) / square;
  return result;
}

}  // namespace

std::vector<OutputValidation> validate_outputs(const std::vector<Variable>& outputs,
                                               const Eigen::MatrixXd& modelled,
                                               const Eigen::MatrixXd& residuals) {
  std::vector<OutputValidation> result;
  for (Index j = 0; j < residuals.cols(); ++j) {
    std::vector<Index> there;
    for (Index row = 0; row < residuals.rows(); ++row) {
      if (!std::isnan(residuals(row, j))) there.push_back(row);
    }
    result.push_back(validate(outputs[static_cast<std::size_t>(j)].name, modelled(there, j),
                              residuals(there, j)));
  }
  return result;
}

}  // namespace sepcal::verbs
