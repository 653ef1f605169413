// SPDX-License-Identifier: BSD-3-Clause
// Attitude that was logged as a quaternion.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/flight.hpp"

namespace sepcal::logs {

/// Where qw, qx, qy and qz are there and no roll, pitch or yaw is: puts roll_rad, pitch_rad and
/// yaw_rad in their place, with a note. The quaternion is Hamilton's, of the rotation from body
/// axes (forward, right, down) to north, east, down; it need not be of unit length, and where it
/// has none the angles are no numbers. Logs that are longer than memory stay as they are.
void convert_quaternion(Flight& flight, std::vector<std::string>& notes);

}  // namespace sepcal::logs
