// SPDX-License-Identifier: BSD-3-Clause
// From what a minimisation ended with to what a fit says of its parameters, whatever the method.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimation/problem.hpp"
#include "sepcal/detail/identifiability.hpp"
#include "sepcal/fit.hpp"

namespace sepcal::estimation {

/// Of the free parameters, k of which no bound holds.
struct FreeEstimate {
  const Eigen::VectorXd& x;
  const std::vector<bool>& at_bound;
  const std::vector<Eigen::Index>& inside;  // places of the k
  const Eigen::MatrixXd& believed;          // k x k, as the others
  const Eigen::MatrixXd& white;
  const Eigen::MatrixXd& noise_model;
  const Eigen::MatrixXd& blocks;
};

/// Spreads the free parameters' estimate and covariances over all of the model's parameters.
void fill_parameters(Fit& result, const BlockModel& model, const Problem& problem,
                     const FreeEstimate& estimate);

/// What the record leaves open, by the factor of the rows over their noise (n x n). Nothing but its
/// bound stopped a parameter that lies on one: where it is exchanged for others, they are as open
/// as it is unless two of its standard errors, not one, fit into half the width.
Identifiability judge_identifiability(const Eigen::MatrixXd& tangent,
                                      const std::vector<std::string>& names,
                                      const Eigen::VectorXd& scale,
                                      const std::vector<bool>& at_bound);

/// A value an output, in the table's order.
std::vector<OutputValue> by_output(const Tables& tables, const Eigen::VectorXd& values);

}  // namespace sepcal::estimation
