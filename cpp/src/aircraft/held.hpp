// SPDX-License-Identifier: BSD-3-Clause
// Parameters that few flights tell apart from others: they are zero unless they are freed.
#pragma once

#include <string>
#include <vector>

#include "sepcal/options.hpp"

namespace sepcal::aircraft {

/// Holds these at zero, those in `free` excepted; what is fixed already stays as it is. Throws
/// Error for one in `free` that is none of these.
void hold_at_zero(const std::vector<std::string>& held, const std::vector<std::string>& free,
                  FitOptions& fit);

}  // namespace sepcal::aircraft
