// SPDX-License-Identifier: BSD-3-Clause
// Rows of a record as rows of the flight that it was made of.
#pragma once

#include <cstddef>
#include <vector>

#include "sepcal/flight/track.hpp"

namespace sepcal::tracks {

/// Sets the flight's rows of a track and of its changes. `flight_rows`: of each row of the record.
inline void set_flight_rows(TrackedFlight& tracked, const std::vector<std::size_t>& flight_rows) {
  for (const std::size_t row : tracked.track.rows) {
    tracked.flight_rows.push_back(flight_rows[row]);
  }
  for (Change& change : tracked.track.changes) {
    change.onset = flight_rows[change.onset];
    change.found = flight_rows[change.found];
  }
}

}  // namespace sepcal::tracks
