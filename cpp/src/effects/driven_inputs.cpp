// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "sepcal/detail/effect.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

/// Adds what isn't there yet.
void add_once(std::vector<Variable>& inputs, const Variable& input) {
  if (std::ranges::find(inputs, input.name, &Variable::name) == inputs.end()) {
    inputs.push_back(input);
  }
}

std::vector<Variable> targets_of(const std::vector<DrivenInput>& components) {
  std::vector<Variable> targets;
  for (const DrivenInput& component : components) add_once(targets, component.target);
  return targets;
}

/// Targets, what multiplies them, the driver.
std::vector<Variable> inputs_of(const Driver& driver, const std::vector<DrivenInput>& components) {
  std::vector<Variable> inputs = targets_of(components);
  for (const DrivenInput& component : components) {
    if (component.times) add_once(inputs, *component.times);
  }
  if (driver.input()) inputs.push_back(*driver.input());
  return inputs;
}

std::vector<Variable> parameters_of(const std::string& owner, const Driver& driver,
                                    const std::vector<DrivenInput>& components,
                                    const std::string& unit, double bounds) {
  std::vector<Variable> parameters;
  for (const DrivenInput& component : components) {
    for (const std::string& suffix : driver.suffixes()) {
      parameters.emplace_back(owner + "." + component.component + suffix, unit, -bounds, bounds);
    }
  }
  if (const auto& shape = driver.shape()) {
    parameters.emplace_back(owner + "." + shape->name, shape->unit, shape->lower, shape->upper);
  }
  return parameters;
}

class DrivenInputs final : public Correction {
 public:
  DrivenInputs(const std::string& owner, DriverPointer driver,
               const std::vector<DrivenInput>& components, const std::string& unit, double bounds)
      : Correction(inputs_of(*driver, components), static_cast<int>(targets_of(components).size()),
                   parameters_of(owner, *driver, components, unit, bounds)),
        driver_(std::move(driver)) {
    for (const DrivenInput& component : components) {
      components_.push_back({place_of(component.target),
                             component.times ? place_of(*component.times) : -1, component.sign});
    }
  }

  bool is_driver(int input) const override {
    return driver_->input() && input + 1 == static_cast<int>(inputs().size());
  }

  double reach() const override { return driver_->reach(); }

  void evaluate(const Block& block, const double* xi2, Ref<MatrixXd> values,
                MatrixXd* slopes) const override {
    const auto rows = static_cast<Index>(block.rows);
    const Index functions = driver_->functions();
    const auto n_u = static_cast<Index>(inputs().size());
    const auto n_2 = static_cast<Index>(nonlinear().size());
    const bool shaped = driver_->shape().has_value();
    MatrixXd phi(rows, functions);
    MatrixXd phi_slopes(rows, functions);
    driver_->evaluate(driver_->input() ? block.inputs.back() : nullptr, block.first,
                      shaped ? xi2[n_2 - 1] : 0.0, phi, shaped ? &phi_slopes : nullptr);
    const auto input = [&](Index i) {
      return Eigen::Map<const VectorXd>(block.inputs[static_cast<std::size_t>(i)], rows);
    };
    if (slopes != nullptr) slopes->setZero();
    for (Index c = 0; c < corrected(); ++c) {
      values.col(c) = input(c);
      if (slopes != nullptr) slopes->col(c * (n_u + n_2) + c).setOnes();
    }
    for (std::size_t k = 0; k < components_.size(); ++k) {
      const auto& [target, times, sign] = components_[k];
      const Index first = static_cast<Index>(k) * functions;
      const Eigen::Map<const VectorXd> s(xi2 + first, functions);
      const VectorXd factor =
          times < 0 ? VectorXd::Constant(rows, sign) : VectorXd(sign * input(times));
      const VectorXd driven = phi * s;
      values.col(target) += factor.cwiseProduct(driven);
      if (slopes == nullptr) continue;
      auto own = slopes->middleCols(target * (n_u + n_2), n_u + n_2);
      if (times >= 0) own.col(times) += sign * driven;
      own.middleCols(n_u + first, functions) = factor.asDiagonal() * phi;
      if (shaped) own.col(n_u + n_2 - 1) += factor.cwiseProduct(phi_slopes * s);
    }
  }

 private:
  struct Component {
    Index target;  // among the inputs
    Index times;   // -1: none
    double sign;
  };

  Index place_of(const Variable& input) const {
    return std::ranges::find(inputs(), input.name, &Variable::name) - inputs().begin();
  }

  DriverPointer driver_;
  std::vector<Component> components_;
};

}  // namespace

std::shared_ptr<const Correction> driven_inputs(const std::string& owner, DriverPointer driver,
                                                const std::vector<DrivenInput>& components,
                                                const std::string& unit, double bounds) {
  return std::make_shared<const DrivenInputs>(owner, std::move(driver), components, unit, bounds);
}

}  // namespace sepcal
