// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/fitted_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "estimation/covariance.hpp"

namespace sepcal::estimation {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void fill_parameters(Fit& result, const BlockModel& model, const Problem& problem,
                     const FreeEstimate& estimate) {
  const std::vector<Variable> all = model.tables().parameters();
  const auto n = static_cast<Index>(all.size());
  result.n_1 = model.tables().n_1();
  std::vector<Index> place;  // of each free parameter among all
  for (const Variable& variable : all) {
    Parameter parameter{.name = variable.name, .unit = variable.unit};
    const auto fixed = problem.options().fix.find(variable.name);
    if (fixed != problem.options().fix.end()) {
      parameter.fixed = true;
      parameter.value = parameter.lower = parameter.upper = fixed->second;
    } else {
      const auto k = place.size();
      place.push_back(static_cast<Index>(result.parameters.size()));
      parameter.value = estimate.x[static_cast<Index>(k)];
      parameter.lower = problem.parameters()[k].lower;
      parameter.upper = problem.parameters()[k].upper;
      parameter.at_bound = estimate.at_bound[k];
    }
    result.parameters.push_back(std::move(parameter));
  }
  std::vector<Index> places;
  for (const Index k : estimate.inside) places.push_back(place[static_cast<std::size_t>(k)]);
  result.covariance = spread(estimate.believed, places, n);
  result.covariance_white = spread(estimate.white, places, n);
  result.covariance_noise_model = spread(estimate.noise_model, places, n);
  result.covariance_blocks = spread(estimate.blocks, places, n);
  result.correlation = correlation_of(result.covariance);
  for (Index k = 0; k < n; ++k) {
    Parameter& parameter = result.parameters[static_cast<std::size_t>(k)];
    parameter.standard_error = std::sqrt(result.covariance(k, k));
    parameter.standard_error_white = std::sqrt(result.covariance_white(k, k));
    parameter.standard_error_noise_model = std::sqrt(result.covariance_noise_model(k, k));
    parameter.standard_error_blocks = std::sqrt(result.covariance_blocks(k, k));
  }
}

Identifiability judge_identifiability(const MatrixXd& tangent,
                                      const std::vector<std::string>& names, const VectorXd& scale,
                                      const std::vector<bool>& at_bound) {
  constexpr double noise_factor = 1.0;  // the tangent's rows are over the noise that was judged
  Identifiability plain = identify(tangent, names, scale, noise_factor);
  if (std::ranges::find(at_bound, true) == at_bound.end()) return plain;
  VectorXd halved = scale;
  for (Index k = 0; k < halved.size(); ++k) {
    if (at_bound[static_cast<std::size_t>(k)]) halved[k] *= 0.5;
  }
  Identifiability strict = identify(tangent, names, halved, noise_factor);
  const bool exchanged = std::ranges::any_of(
      strict.unobservable, [](const Combination& open) { return open.parameters.size() > 1; });
  return exchanged ? strict : plain;
}

std::vector<OutputValue> by_output(const Tables& tables, const VectorXd& values) {
  std::vector<OutputValue> result;
  for (Index j = 0; j < values.size(); ++j) {
    result.push_back({tables.outputs[static_cast<std::size_t>(j)].name, values[j]});
  }
  return result;
}

}  // namespace sepcal::estimation
