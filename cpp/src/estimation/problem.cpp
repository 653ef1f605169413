// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/problem.hpp"

#include <algorithm>
#include <cmath>

#include "base/name_list.hpp"
#include "model/fixed_model.hpp"
#include "sepcal/error.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// The variable of that name, or an Error that lists those there are.
Variable& find(std::vector<Variable>& variables, const std::string& name, const std::string& what) {
  const auto at = std::ranges::find(variables, name, &Variable::name);
  if (at == variables.end()) {
    throw Error("there is no " + what + " '" + name +
                "'; the model has: " + base::list_names(variables));
  }
  return *at;
}

void check_at_least(const std::string& option, int value, int least) {
  if (value >= least) return;
  throw Error(option + " is " + std::to_string(value) + "; it must be at least " +
              std::to_string(least));
}

void check_screens(const Screens& screens) {
  if (!(screens.t_1 > 0) || !(screens.t_2 > 0)) {
    throw Error("the screens' t_1 and t_2 must be positive");
  }
  if (!(screens.l_2 >= 0) || !std::isfinite(screens.l_2)) {
    throw Error("the screens' l_2 must be positive, or 0 for the farthest corner of the bounds");
  }
}

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
  std::vector<Variable> all = model.tables().parameters();
  for (const auto& [name, bounds] : options.bounds) {
    Variable& parameter = find(all, name, "parameter");
    if (!(bounds.lower < bounds.upper)) {
      throw Error("the bounds of '" + name + "' leave no room; the lower must be below the upper" +
                  " (to hold a parameter at a value, fix it)");
    }
    parameter.lower = bounds.lower;
    parameter.upper = bounds.upper;
  }
  for (const auto& [name, drawn] : options.sampling_distribution) {
    std::vector<Variable> nonlinear = model.tables().nonlinear;
    find(nonlinear, name, "nonlinear parameter (only these are sampled)");
  }
  for (const auto& [name, value] : options.start) {
    std::vector<Variable> nonlinear = model.tables().nonlinear;
    find(nonlinear, name, "nonlinear parameter (only these have a start)");
    if (!std::isfinite(value)) throw Error("the start of '" + name + "' is not a finite number");
  }
  for (const auto& [name, value] : options.unsampled) {
    std::vector<Variable> nonlinear = model.tables().nonlinear;
    find(nonlinear, name, "nonlinear parameter (only these are sampled)");
  }
  for (const auto& [name, normal] : options.prior) {
    find(all, name, "parameter");
    const double sd = normal.standard_deviation;
    if (!std::isfinite(normal.mean) || !(sd > 0) || !std::isfinite(sd)) {
      throw Error("the prior of '" + name +
                  "' must have a finite mean and a positive standard deviation");
    }
    if (options.fixed.contains(name)) {
      throw Error("'" + name + "' is fixed, so that its prior has no part; drop one");
    }
  }
  for (const auto& [name, value] : options.fixed) {
    const Variable& parameter = find(all, name, "parameter");
    if (!std::isfinite(value) || value < parameter.lower || value > parameter.upper) {
      throw Error("the fixed value of '" + name + "' is outside its bounds; widen them or mend it");
    }
  }
  if (!options.fixed.empty()) {
    held_ = std::make_unique<const model::FixedModel>(model, options.fixed);
    free_ = held_.get();
  }
  for (const Variable& parameter : all) {
    if (!options.fixed.contains(parameter.name)) parameters_.push_back(parameter);
  }
  if (parameters_.empty()) {
    throw Error("every parameter is fixed, so that nothing is left to estimate; free one");
  }

  std::vector<Variable> outputs = model.tables().outputs;
  for (const auto& [name, sd] : options.noise) {
    find(outputs, name, "output");
    if (!(sd > 0) || !std::isfinite(sd)) {
      throw Error("the noise of output '" + name + "' must be a positive standard deviation");
    }
  }
  if (!options.noise.empty()) {
    noise_.resize(model.tables().n_z());
    for (Index j = 0; j < noise_.size(); ++j) {
      const std::string& name = outputs[static_cast<std::size_t>(j)].name;
      const auto at = options.noise.find(name);
      if (at == options.noise.end()) {
        throw Error("noise is given, but not for output '" + name + "'; give it for every output");
      }
      noise_[j] = at->second;
    }
  }
  check_at_least("samples", options.samples, 0);
  check_at_least("descents", options.descents, 1);
  check_at_least("iterations", options.iterations, 1);
  check_at_least("noise_iterations", options.noise_iterations, 1);
  check_at_least("threads", options.threads, 0);
  if (!(options.loss_width >= 0) || !std::isfinite(options.loss_width)) {
    throw Error("loss_width must be positive, or 0 for the loss's own");
  }
  if (options.loss_width > 0 && options.loss == Loss::squares) {
    throw Error("loss_width is given without a loss; choose huber or cauchy, or leave it out");
  }
  if (options.screens) check_screens(*options.screens);
  if (!(options.noise_tolerance > 0)) throw Error("noise_tolerance must be positive");
}

std::vector<Variable> Problem::nonlinear() const {
  return {parameters_.begin() + model().tables().n_1(), parameters_.end()};
}

numerics::Box Problem::box() const { return box_of(parameters_, 0); }

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
