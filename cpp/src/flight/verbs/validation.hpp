// SPDX-License-Identifier: BSD-3-Clause
// How well a model follows what was measured: R^2, and Theil's inequality coefficient with its
// parts (Theil, Applied Economic Forecasting, 1966; Jategaonkar, Flight Vehicle System
// Identification, 2nd ed., ch. 11).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sepcal/detail/tables.hpp"
#include "sepcal/flight/comparison.hpp"

namespace sepcal::verbs {

/// One an output. `modelled` and `residuals` (z - modelled): N x n_z, NaN where there is no
/// reading.
std::vector<OutputValidation> validate_outputs(const std::vector<Variable>& outputs,
                                               const Eigen::MatrixXd& modelled,
                                               const Eigen::MatrixXd& residuals);

}  // namespace sepcal::verbs
