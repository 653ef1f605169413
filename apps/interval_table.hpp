// SPDX-License-Identifier: BSD-3-Clause
// Both kinds of interval, side by side, for people.
#pragma once

#include <string>

#include "sepcal/flight/intervals.hpp"

namespace sepcal::app {

std::string interval_table(const FlightIntervals& intervals);

}  // namespace sepcal::app
