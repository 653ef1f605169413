// SPDX-License-Identifier: BSD-3-Clause
// The one of total, static and impact pressure that the other two give.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/flight.hpp"

namespace sepcal::logs {

/// Of a tube that logs pt and ps and neither an airspeed nor dp: adds dp_pa = pt - ps. Of a
/// five-hole probe (dpa is there) with dp and ps and no pt: adds pt_pa = ps + dp. A note says so.
/// Logs that are longer than memory stay as they are.
void complete_pressures(Flight& flight, std::vector<std::string>& notes);

}  // namespace sepcal::logs
