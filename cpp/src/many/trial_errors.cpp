// SPDX-License-Identifier: BSD-3-Clause
#include "many/trial_errors.hpp"

#include <cmath>

#include "sepcal/detail/identifiability.hpp"
#include "sepcal/detail/triangular_factor.hpp"

namespace sepcal::many {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TrialErrors::TrialErrors(const estimation::Problem& problem, std::size_t rows) {
  const std::vector<Variable>& parameters = problem.parameters();
  const auto n = static_cast<Index>(parameters.size());
  const double count = static_cast<double>(rows) * problem.model().tables().n_z();
  ratio_ = problem.noise().size() > 0 ? 1.0 : std::sqrt(count / (count - static_cast<double>(n)));
  half_widths_.resize(n);
  for (Index k = 0; k < n; ++k) {
    const Variable& parameter = parameters[static_cast<std::size_t>(k)];
    half_widths_[k] = 0.5 * (parameter.upper - parameter.lower);
    names_.push_back(parameter.name);
  }
  inverse_.resize(n, n);
  scale_.resize(n);
  errors_.resize(n);
}

std::optional<std::string> TrialErrors::judge(const TrialEnd& end) {
  const Index n = errors_.size();
  invert(end.R);
  double in_scale = 0.0;   // |(R S)^-1|^2, S the plausible lengths
  double in_length = 0.0;  // the same with columns of length one
  for (Index k = 0; k < n; ++k) {
    const bool bounded = std::isfinite(half_widths_[k]);
    scale_[k] = bounded ? half_widths_[k] : std::sqrt(end.z_square) / end.lengths[k];
    errors_[k] = ratio_ * inverse_.row(k).tail(n - k).norm();
    in_scale += std::pow(errors_[k] / scale_[k], 2);
    in_length += std::pow(errors_[k] / ratio_, 2) * end.R.col(k).head(k + 1).squaredNorm();
  }
  // Singular values are at least one over the norm of the inverse: far from what identify() minds.
  constexpr double well_determined = 0.25;
  constexpr double well_apart = 40.0 * 40.0;
  if (!(in_scale < well_determined)) return std::nullopt;
  if (in_length * static_cast<double>(n) < well_apart) return "";
  return identify(end);
}

/// inverse_ = R^-1, upper triangular.
void TrialErrors::invert(const MatrixXd& R) {
  for (Index c = 0; c < errors_.size(); ++c) {
    inverse_(c, c) = 1.0 / R(c, c);
    for (Index i = c; i-- > 0;) {
      double sum = 0.0;
      for (Index k = i + 1; k <= c; ++k) sum -= R(i, k) * inverse_(k, c);
      inverse_(i, c) = sum / R(i, i);
    }
  }
}

std::optional<std::string> TrialErrors::identify(const TrialEnd& end) const {
  const Index n = errors_.size();
  TriangularFactor factor(static_cast<int>(n) + 1);
  MatrixXd rows = end.R / ratio_;
  factor.absorb(rows);
  const Identifiability seen =
      sepcal::identify(factor.matrix().topLeftCorner(n, n), names_, scale_, 1.0);
  if (!seen.unobservable.empty()) return std::nullopt;
  return seen.message();
}

}  // namespace sepcal::many
