// SPDX-License-Identifier: BSD-3-Clause
// A fit's question, checked and complete: the model without its fixed parameters, the bounds that
// hold, the noise where it is given. Both stages take this and add nothing to it.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "estimation/minimise.hpp"
#include "sepcal/detail/block_model.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal::estimation {

/// Throws Error as check_options() does.
class Problem {
 public:
  Problem(const BlockModel& model, const FitOptions& options);

  /// Free parameters only.
  const BlockModel& model() const { return *free_; }
  const FitOptions& options() const { return options_; }

  /// Free parameters with the bounds that hold: n_1 linear, then n_2 nonlinear.
  const std::vector<Variable>& parameters() const { return parameters_; }
  std::vector<Variable> nonlinear() const;

  numerics::Box box() const;            // of all free parameters
  numerics::Box linear_box() const;     // of xi1
  numerics::Box nonlinear_box() const;  // of xi2

  /// Of the free parameters: one prior over all of them, or none.
  std::vector<Prior> prior() const;

  /// Given noise standard deviations (n_z), or empty where R is to be estimated.
  const Eigen::VectorXd& noise() const { return noise_; }

  /// Throws Error where a record has fewer measurements than there are free parameters.
  void check_measurements(std::size_t rows) const;

 private:
  FitOptions options_;
  std::unique_ptr<const BlockModel> held_;  // what free_ points to where something is fixed
  const BlockModel* free_;
  std::vector<Variable> parameters_;
  Eigen::VectorXd noise_;
};

}  // namespace sepcal::estimation
