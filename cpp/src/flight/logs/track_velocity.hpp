// SPDX-License-Identifier: BSD-3-Clause
// Velocity of a log that has the speed over the ground and the track.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/flight.hpp"

namespace sepcal::logs {

/// Where magvar (positive to the east) and a magnetic heading are there and no yaw: adds yaw_rad,
/// with a note.
void turn_heading(Flight& flight, std::vector<std::string>& notes);

/// Where gs and track are there and neither vn nor ve: adds vn_mps and ve_mps, with a note. A track
/// that is magnetic is turned by magvar, and is not used without it; of one that does not say so,
/// beside magvar, the positions tell. At a standstill, below 1 m/s, a track may be missing. Logs
/// that are longer than memory stay as they are.
void derive_from_track(Flight& flight, std::vector<std::string>& notes);

/// Where vn and ve are there and no vd: adds vd_mps of the smoothed altitude, with a note; of a log
/// with gs and track that has no altitude either, zero, as of level flight, and says so.
void derive_climb(Flight& flight, std::vector<std::string>& notes);

}  // namespace sepcal::logs
