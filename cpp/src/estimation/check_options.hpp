// SPDX-License-Identifier: BSD-3-Clause
// The options of a fit against the tables of its model, before anything is computed.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sepcal/detail/tables.hpp"
#include "sepcal/options.hpp"

namespace sepcal::estimation {

/// The table's parameters, linear first, with `bounds` in place of their own.
std::vector<Variable> with_bounds(const Tables& tables,
                                  const std::map<std::string, Interval>& bounds);

/// Throws Error for a name in bounds, sampling_distribution, start, unsampled, prior, fixed or
/// noise that the model doesn't have, an interval that is empty, a fixed value outside its bounds,
/// a parameter that is fixed and has a prior, nothing left to estimate, noise that is not positive
/// or is not given for every output, and a number out of its range.
void check_options(const FitOptions& options, const Tables& tables);

/// Throws OptionError for a choice of stage one's samples where nothing is sampled; `why` ends the
/// sentence "this fit samples nothing: ".
void refuse_sampling(const FitOptions& options, const std::string& why);

}  // namespace sepcal::estimation
