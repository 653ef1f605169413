// SPDX-License-Identifier: BSD-3-Clause
// Inputs of a model without their white noise, which columns of a tangent are made of: noise that
// stands in the columns and in the residual alike could be cancelled, by coefficients that take the
// model away.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "sepcal/block_model.hpp"
#include "sepcal/record.hpp"

namespace sepcal::diagnosis {

/// `x` smoothed by local quadratics over the window that Stein's unbiased estimate of the risk says
/// is best, of 5 to 65 values; as it is where none is better, which is so of what is not noisy.
std::vector<double> smooth(std::span<const double> x);

/// Every input of these tables but the time, smoothed segment by segment, by its name in the
/// record. Angles that wrap go on beyond pi.
std::map<std::string, std::vector<double>> smooth_inputs(const Record& record,
                                                         const Tables& tables);

}  // namespace sepcal::diagnosis
