// SPDX-License-Identifier: BSD-3-Clause
// One column held against others: units that a header gets wrong, axes that are swapped or turned
// round, readings that no flight has.
#pragma once

#include "flight/checks/motion.hpp"

namespace sepcal::checks {

void check_across(const Log& log, const Settings& settings, std::vector<LogNote>& notes);

}  // namespace sepcal::checks
