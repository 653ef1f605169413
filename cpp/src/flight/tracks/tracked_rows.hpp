// SPDX-License-Identifier: BSD-3-Clause
// What is done to a track of a record, for the flight that the record was made of.
#pragma once

#include <cstddef>
#include <vector>

#include "sepcal/flight/track.hpp"

namespace sepcal::tracks {

/// Sets the flight's rows of a track and of its changes, and adds notes where innovations correlate
/// and where a parameter drifts. `flight_rows`: of each row of the record.
void place_in_flight(TrackedFlight& tracked, const std::vector<std::size_t>& flight_rows);

}  // namespace sepcal::tracks
