// SPDX-License-Identifier: BSD-3-Clause
// When the model fails: the rows cut into twenty windows, and the worst of them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sepcal/flight/comparison.hpp"

namespace sepcal::verbs {

/// The five windows of the largest RMSE over all outputs, each divided by its noise (its RMSE over
/// the whole flight where `noise` knows none); worst first, the earlier first among equals. `time`
/// and `residuals` (rows x n_z) have a row each, `overall` an output each. Short flights have
/// fewer windows, of five rows at least.
std::vector<Window> find_worst_windows(const std::vector<double>& time,
                                       const Eigen::MatrixXd& residuals,
                                       const std::vector<Misfit>& overall,
                                       const std::vector<OutputValue>& noise);

}  // namespace sepcal::verbs
