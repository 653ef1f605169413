// SPDX-License-Identifier: BSD-3-Clause
// Velocity of a log that has positions or altitudes alone, and its positions in metres.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/flight.hpp"

namespace sepcal::logs {

/// Where lat, lon, altitude and time are there and neither vn nor ve: adds vn_mps, ve_mps and,
/// where there is none, vd_mps of the smoothed track, with a note. A row that repeats the position
/// before it is no new fix; between fixes the velocity is that of the cubic through them. Logs that
/// are longer than memory stay as they are. Whether it added them.
bool derive_velocity(Flight& flight, std::vector<std::string>& notes);

/// Where lat, lon, altitude and time are there and neither north nor east: adds north_m, east_m and
/// down_m from the first fix on, over the ellipsoid, empty in rows without a new fix, with a note.
void derive_position(Flight& flight, std::vector<std::string>& notes);

/// Where altitude and time are there: adds vd_mps of the smoothed altitude, with a note, and
/// returns true. A value that is held, of a sensor slower than the log, is no new one.
bool smooth_climb(Flight& flight, std::vector<std::string>& notes);

/// Where vu is there, positive up, and no vd: adds vd_mps, with a note.
void turn_climb(Flight& flight, std::vector<std::string>& notes);

}  // namespace sepcal::logs
