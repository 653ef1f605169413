// SPDX-License-Identifier: BSD-3-Clause
// Time of logs that have the GPS's week and time of week alone.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/flight.hpp"

namespace sepcal::logs {

/// Where gps_tow is there (s or ms; GMS of an ArduPilot log is in ms; of a bare `tow` its size and
/// steps tell) and no time: adds time_s,
/// from the start of the first week on, with a note. Weeks are those of gps_week or GWk; without
/// them a time of week that runs back by more than half a week begins another. Logs that are longer
/// than memory stay as they are.
void derive_time(Flight& flight, std::vector<std::string>& notes);

}  // namespace sepcal::logs
