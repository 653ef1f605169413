// SPDX-License-Identifier: BSD-3-Clause
// What came of what was known beforehand, where a reader has to know it.
#pragma once

#include <string>
#include <vector>

#include "sepcal/fit.hpp"

namespace sepcal::estimation {

/// One sentence for each parameter that came out far from what was known of it, or less sure than
/// it was known; they end in "; ".
std::string judge_knowledge(const std::vector<Parameter>& parameters, const FitOptions& options);

}  // namespace sepcal::estimation
