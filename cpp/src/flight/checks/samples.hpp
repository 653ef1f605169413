// SPDX-License-Identifier: BSD-3-Clause
// What was sampled: columns held from row to row, interpolated, or on coarse steps.
#pragma once

#include "flight/checks/log.hpp"

namespace sepcal::checks {

void check_samples(const Log& log, std::vector<LogNote>& notes);

}  // namespace sepcal::checks
