// SPDX-License-Identifier: BSD-3-Clause
// Stamps of time that several rows share, since the clock shows no more digits.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/flight.hpp"

namespace sepcal::logs {

/// Where most stamps stand in several rows each, such as whole seconds of rows at 5 Hz: spreads the
/// rows evenly over the time to the next stamp, with a note. Rows that repeat the row before them
/// whole are none of these, and logs that are longer than memory stay as they are.
void spread_stamps(Flight& flight, std::vector<std::string>& notes);

}  // namespace sepcal::logs
