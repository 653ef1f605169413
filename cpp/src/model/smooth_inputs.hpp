// SPDX-License-Identifier: BSD-3-Clause
// Inputs of a model without their white noise. Noise in the inputs pulls estimates (errors in
// variables), and where it stands in the columns of a tangent and in the residual alike, it could
// be cancelled there by coefficients that take the model away.
#pragma once

#include <span>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/record.hpp"

namespace sepcal::model {

/// `x` smoothed by local quadratics over the window that Stein's unbiased estimate of the risk says
/// is best, of 5 to 65 values; as it is where none is better, which is so of what is not noisy.
std::vector<double> smooth(std::span<const double> x);

/// The record with every input of these tables but the time smoothed segment by segment. What is an
/// output too stays as it is. Angles stay in the turn that they were logged in.
Record smooth_inputs(const Record& record, const Tables& tables);

}  // namespace sepcal::model
