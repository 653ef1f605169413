// SPDX-License-Identifier: BSD-3-Clause
// What a fit's result says of itself: no estimator, so that reading one back needs none.
#include <algorithm>

#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"

namespace sepcal {

std::string_view to_string(FitStatus status) {
  switch (status) {
    case FitStatus::converged:
      return "converged";
    case FitStatus::not_identifiable:
      return "not_identifiable";
    default:
      return "not_converged";
  }
}

const Parameter& Fit::operator[](std::string_view name) const {
  const auto at = std::ranges::find(parameters, name, &Parameter::name);
  if (at != parameters.end()) return *at;
  std::string known;
  for (const Parameter& parameter : parameters)
    known += (known.empty() ? "" : ", ") + parameter.name;
  throw Error("there is no parameter '" + std::string(name) + "'; the fit has: " + known);
}

Eigen::VectorXd Fit::values() const {
  Eigen::VectorXd result(static_cast<Eigen::Index>(parameters.size()));
  for (Eigen::Index k = 0; k < result.size(); ++k)
    result[k] = parameters[static_cast<std::size_t>(k)].value;
  return result;
}

std::map<std::string, double> Fit::by_name() const {
  std::map<std::string, double> result;
  for (const Parameter& parameter : parameters) result[parameter.name] = parameter.value;
  return result;
}

std::map<std::string, double> Fit::process_noise() const {
  std::map<std::string, double> sizes;
  for (const NoiseSize& size : noise_sizes) {
    if (size.name.starts_with("q_") && size.value > 0.0) sizes[size.name.substr(2)] = size.value;
  }
  return sizes;
}

std::map<std::string, double> Fit::nonlinear_estimates() const {
  std::map<std::string, double> result;
  for (auto k = static_cast<std::size_t>(n_1); k < parameters.size(); ++k) {
    if (!parameters[k].fixed) result[parameters[k].name] = parameters[k].value;
  }
  return result;
}

}  // namespace sepcal
