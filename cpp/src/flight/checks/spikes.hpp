// SPDX-License-Identifier: BSD-3-Clause
// Single readings far off their neighbours, and readings that stand at a limit.
#pragma once

#include "flight/checks/log.hpp"

namespace sepcal::checks {

void check_spikes(const Log& log, std::vector<LogNote>& notes);

}  // namespace sepcal::checks
