// SPDX-License-Identifier: BSD-3-Clause
// Peaks that a sensor cut off at its limit.
#pragma once

#include "flight/checks/log.hpp"

namespace sepcal::checks {

void check_clipping(const Log& log, std::vector<LogNote>& notes);

}  // namespace sepcal::checks
