// SPDX-License-Identifier: BSD-3-Clause
// The time stamps: that repeat or run back, that leave gaps, that come unevenly or in bursts.
#pragma once

#include "flight/checks/log.hpp"

namespace sepcal::checks {

void check_clock(const Log& log, std::vector<LogNote>& notes);

}  // namespace sepcal::checks
