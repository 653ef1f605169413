// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/process_noise.hpp"

#include <algorithm>
#include <cmath>

#include "base/parameter_values.hpp"
#include "base/sentences.hpp"
#include "base/short_number.hpp"
#include "estimation/covariance.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double worth_a_word = 1.1;  // times the standard error

VectorXd densities(const BlockModel& model, const FitOptions& options) {
  const auto noises = model.process_noises();
  return base::deviations_in_order({noises.begin(), noises.end()}, options.process_noise,
                                   "process noise");
}

/// Places of the parameters that have a standard error.
std::vector<Index> estimated(const Fit& fit) {
  std::vector<Index> places;
  for (Index k = 0; k < fit.covariance.rows(); ++k) {
    if (fit.covariance_white(k, k) > 0.0 && fit.covariance(k, k) > 0.0) places.push_back(k);
  }
  return places;
}

/// `covariance`, whose standard errors are at least those that were believed without it.
MatrixXd widen(const MatrixXd& covariance, const MatrixXd& believed) {
  const VectorXd scale =
      (believed.diagonal().cwiseQuotient(covariance.diagonal())).cwiseMax(1.0).cwiseSqrt();
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

}  // namespace

void estimation::check_process_noise(const BlockModel& model, const FitOptions& options) {
  densities(model, options);
}

void estimation::allow_for_process_noise(Fit& result, const BlockModel& model, const Record& record,
                                         const FitOptions& options) {
  if (options.process_noise.empty()) return;
  const std::vector<Index> inside = estimated(result);
  if (inside.empty()) return;
  VectorXd noise(static_cast<Index>(result.noise.size()));
  for (Index j = 0; j < noise.size(); ++j) {
    noise[j] = result.noise[static_cast<std::size_t>(j)].value;
  }
  const MatrixXd score =
      model.score_noise(record, result.values(), noise, densities(model, options))(inside, inside);
  if (!score.allFinite()) return;  // a state ran away, which is said elsewhere
  const MatrixXd inverse = result.covariance_white(inside, inside);
  const MatrixXd believed = result.covariance(inside, inside);
  const MatrixXd wide = widen(inverse + inverse * score * inverse, believed);

  double most = 1.0;
  std::string name;
  for (std::size_t i = 0; i < inside.size(); ++i) {
    Parameter& parameter = result.parameters[static_cast<std::size_t>(inside[i])];
    const double error = std::sqrt(wide(static_cast<Index>(i), static_cast<Index>(i)));
    if (error > most * parameter.standard_error) {
      most = error / parameter.standard_error;
      name = parameter.name;
    }
    parameter.standard_error = error;
  }
  result.covariance(inside, inside) = wide;
  result.correlation = correlation_of(result.covariance);
  if (most < worth_a_word) return;
  result.message = base::join_sentences(
      {result.message, "process noise makes standard errors up to " + base::short_number(most) +
                           " times as large (" + name + ")"});
}

}  // namespace sepcal
