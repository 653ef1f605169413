// SPDX-License-Identifier: BSD-3-Clause
// What a reader has to know of a fit's standard errors: where two ways disagree, and where a record
// is too short, too much cut or too smooth to tell.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimation/covariance.hpp"
#include "model/sweep.hpp"
#include "sepcal/detail/quantity.hpp"

namespace sepcal::estimation {

/// Blocks are believed from here on: so many times the noise model's standard error.
inline constexpr double far_apart = 2.0;

/// The same, but where an output's noise moves with the columns that were fitted: 1.
double believed_from(const Covariances& covariances);

/// `parameters`: those of the covariances, k. `blocks` (k): their block errors, NaN where
/// undefined.
std::vector<std::string> describe_errors(const std::vector<std::string>& parameters,
                                         const Covariances& covariances,
                                         const Eigen::VectorXd& blocks, const model::Sweep& sweep);

/// Of how many rows of a record too long for memory the errors are.
std::string describe_sample(const Covariances& covariances, const model::Sweep& sweep,
                            const model::Sweep& sampled);

}  // namespace sepcal::estimation
