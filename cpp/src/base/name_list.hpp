// SPDX-License-Identifier: BSD-3-Clause
// Names as messages list them.
#pragma once

#include <string>
#include <vector>

#include "sepcal/quantity.hpp"

namespace sepcal::base {

/// "a, b, c", or "none".
std::string list_names(const std::vector<std::string>& names);
std::string list_names(const std::vector<Variable>& variables);

}  // namespace sepcal::base
