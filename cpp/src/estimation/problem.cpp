// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/problem.hpp"

#include "estimation/check_options.hpp"
#include "model/fixed_model.hpp"
#include "sepcal/error.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

numerics::Box box_of(const std::vector<Variable>& parameters, std::size_t first) {
  const auto n = static_cast<Index>(parameters.size() - first);
  numerics::Box box{VectorXd(n), VectorXd(n)};
  for (Index k = 0; k < n; ++k) {
    box.lower[k] = parameters[first + static_cast<std::size_t>(k)].lower;
    box.upper[k] = parameters[first + static_cast<std::size_t>(k)].upper;
  }
  return box;
}

}  // namespace

Problem::Problem(const BlockModel& model, const FitOptions& options)
    : options_(options), free_(&model) {
  check_options(options, model.tables());
  if (!options.fix.empty()) {
    held_ = std::make_unique<const model::FixedModel>(model, options.fix);
    free_ = held_.get();
  }
  for (const Variable& parameter : with_bounds(model.tables(), options.bounds)) {
    if (!options.fix.contains(parameter.name)) parameters_.push_back(parameter);
  }
  if (options.noise.empty()) return;
  noise_.resize(model.tables().n_z());
  for (Index j = 0; j < noise_.size(); ++j) {
    noise_[j] = options.noise.at(model.tables().outputs[static_cast<std::size_t>(j)].name);
  }
}

std::vector<Variable> Problem::nonlinear() const {
  return {parameters_.begin() + model().tables().n_1(), parameters_.end()};
}

numerics::Box Problem::box() const { return box_of(parameters_, 0); }

numerics::Box Problem::linear_box() const {
  const auto [lower, upper] = box();
  const Index n_1 = model().tables().n_1();
  return {lower.head(n_1), upper.head(n_1)};
}

numerics::Box Problem::nonlinear_box() const {
  return box_of(parameters_, static_cast<std::size_t>(model().tables().n_1()));
}

std::vector<Prior> Problem::prior() const {
  if (options_.prior.empty()) return {};
  const auto n = static_cast<Index>(parameters_.size());
  Prior prior{VectorXd::Zero(n), VectorXd::Zero(n)};
  for (Index k = 0; k < n; ++k) {
    const auto given = options_.prior.find(parameters_[static_cast<std::size_t>(k)].name);
    if (given == options_.prior.end()) continue;
    prior.mean[k] = given->second.mean;
    prior.weight[k] = 1.0 / given->second.standard_deviation;
  }
  return {prior};
}

void Problem::check_measurements(std::size_t rows) const {
  const std::size_t outputs = model().tables().outputs.size();
  if (rows * outputs >= parameters_.size()) return;
  throw Error("the record has " + std::to_string(rows) + " rows of " + std::to_string(outputs) +
              " outputs, fewer measurements than the " + std::to_string(parameters_.size()) +
              " parameters; log more or fix parameters");
}

}  // namespace sepcal::estimation
