// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/effect.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;

std::vector<Variable> inputs_of(const Driver& driver, const std::vector<DrivenInput>& targets) {
  std::vector<Variable> inputs;
  for (const DrivenInput& target : targets) inputs.push_back(target.target);
  if (driver.input()) inputs.push_back(*driver.input());
  return inputs;
}

std::vector<Variable> parameters_of(const std::string& owner, const Driver& driver,
                                    const std::vector<DrivenInput>& targets,
                                    const std::string& unit, double bounds) {
  std::vector<Variable> parameters;
  for (const DrivenInput& target : targets) {
    for (const std::string& suffix : driver.suffixes()) {
      parameters.emplace_back(owner + "." + target.component + suffix, unit, -bounds, bounds);
    }
  }
  if (const auto& shape = driver.shape()) {
    parameters.emplace_back(owner + "." + shape->name, shape->unit, shape->lower, shape->upper);
  }
  return parameters;
}

class DrivenInputs final : public Correction {
 public:
  DrivenInputs(const std::string& owner, DriverPointer driver, std::vector<DrivenInput> targets,
               const std::string& unit, double bounds)
      : Correction(inputs_of(*driver, targets), static_cast<int>(targets.size()),
                   parameters_of(owner, *driver, targets, unit, bounds)),
        driver_(std::move(driver)),
        targets_(std::move(targets)) {}

  bool is_driver(int input) const override { return input == corrected(); }

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
    driver_->evaluate(driver_->input() ? block.inputs[targets_.size()] : nullptr, block.first,
                      shaped ? xi2[n_2 - 1] : 0.0, phi, shaped ? &phi_slopes : nullptr);
    if (slopes != nullptr) slopes->setZero();
    for (Index c = 0; c < corrected(); ++c) {
      const DrivenInput& target = targets_[static_cast<std::size_t>(c)];
      const Eigen::Map<const Eigen::VectorXd> s(xi2 + c * functions, functions);
      const Eigen::Map<const Eigen::VectorXd> input(block.inputs[static_cast<std::size_t>(c)],
                                                    rows);
      values.col(c) = input + target.sign * phi * s;
      if (slopes == nullptr) continue;
      auto own = slopes->middleCols(c * (n_u + n_2), n_u + n_2);
      own.col(c).setOnes();
      own.middleCols(n_u + c * functions, functions) = target.sign * phi;
      if (shaped) own.col(n_u + n_2 - 1) = target.sign * phi_slopes * s;
    }
  }

 private:
  DriverPointer driver_;
  std::vector<DrivenInput> targets_;
};

}  // namespace

std::shared_ptr<const Correction> driven_inputs(const std::string& owner, DriverPointer driver,
                                                std::vector<DrivenInput> targets,
                                                const std::string& unit, double bounds) {
  return std::make_shared<const DrivenInputs>(owner, std::move(driver), std::move(targets), unit,
                                              bounds);
}

}  // namespace sepcal
