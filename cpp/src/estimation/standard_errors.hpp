// SPDX-License-Identifier: BSD-3-Clause
// Standard errors by three ways, and which of them to believe.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimation/covariance.hpp"
#include "estimation/stage_two.hpp"
#include "model/sweep.hpp"

namespace sepcal::estimation {

struct StandardErrors {
  Eigen::MatrixXd believed;  // k x k, of the free parameters that no bound holds, as `blocks`
  Eigen::MatrixXd blocks;    // k x k; NaN for what too few blocks determine
  std::vector<std::string> sentences;  // what a reader has to know of them
};

/// `covariances`: of the same fit. Without FitOptions::coloured_errors the white errors are
/// believed, and no others are asked for.
StandardErrors find_standard_errors(const Problem& problem, const model::Sweep& sweep,
                                    const SampledRows& sampled, const StageTwo& two,
                                    const Covariances& covariances);

}  // namespace sepcal::estimation
