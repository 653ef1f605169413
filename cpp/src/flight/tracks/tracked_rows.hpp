// SPDX-License-Identifier: BSD-3-Clause
// What is done to a track of a record, for the flight that the record was made of.
#pragma once

#include <cstddef>
#include <vector>

#include "sepcal/flight/track.hpp"

namespace sepcal::tracks {

/// Sets the flight's rows of a track and of its changes. `flight_rows`: of each row of the record.
void set_flight_rows(TrackedFlight& tracked, const std::vector<std::size_t>& flight_rows);

/// Adds a note where neighbouring innovations of an output correlate, as in gusts: the filter then
/// takes each row for news, and its standard deviations are too small.
void note_colour(TrackedFlight& tracked);

/// Adds a note where a parameter jumped three times or more, always the same way: it drifts.
void note_drift(TrackedFlight& tracked);

}  // namespace sepcal::tracks
