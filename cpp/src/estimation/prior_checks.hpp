// SPDX-License-Identifier: BSD-3-Clause
// Whether estimates agree with their priors, where a reader has to know it.
#pragma once

#include <string>
#include <vector>

#include "sepcal/fit.hpp"

namespace sepcal::estimation {

/// One sentence for each parameter that came out far from its prior, or less sure than it.
std::vector<std::string> judge_priors(const std::vector<Parameter>& parameters,
                                      const FitOptions& options);

}  // namespace sepcal::estimation
