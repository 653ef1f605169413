// SPDX-License-Identifier: BSD-3-Clause
// The boxes of the parameters.
#pragma once

#include <map>
#include <string>

#include "certificate/enclosed_problem.hpp"
#include "sepcal/detail/tables.hpp"

namespace sepcal::certificate {

struct Limits {
  Ranges linear = {};     // n_1
  Ranges nonlinear = {};  // n_2
};

/// The model's bounds, or those given. Throws Error for a name that is no parameter, bounds that
/// are no range, and nonlinear parameters that have none.
Limits limits_of(const Tables& tables, const std::map<std::string, Interval>& bounds);

}  // namespace sepcal::certificate
