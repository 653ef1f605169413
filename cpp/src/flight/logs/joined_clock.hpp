// SPDX-License-Identifier: BSD-3-Clause
// Logs that were joined, each with a clock that starts anew.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/flight.hpp"

namespace sepcal::logs {

/// Where time runs back seldom and far, each part longer than a few rows, it is taken for a clock
/// that starts anew: parts follow each other after a gap, which starts a new segment, and a note
/// says so. Other logs stay as they are, and so do those that are longer than memory.
void join_clock(Flight& flight, std::vector<std::string>& notes);

}  // namespace sepcal::logs
