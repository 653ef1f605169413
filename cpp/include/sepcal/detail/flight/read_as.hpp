// SPDX-License-Identifier: BSD-3-Clause
// A log as a probe reads it.
#pragma once

#include <string>
#include <vector>

#include "sepcal/detail/flight/log_choice.hpp"
#include "sepcal/flight/flight.hpp"

namespace sepcal {

struct ReadFlight {
  Flight flight;                   // shares the columns' memory with the log
  std::vector<std::string> notes;  // what was done to it, one line each, for people
  bool velocity_is_of_positions = false;
};

/// The log's columns as `choice` maps and ignores them; those that clearly are a quantity under
/// another name under sepcal's ("GPS_VN (m/s)": vn_mps); clocks that start anew joined; attitude
/// from a quaternion (qw, qx, qy, qz, body to north-east-down) where no angles are logged; velocity
/// from speed and track (gs_mps, track_deg, vs_mps) or from positions (lat_deg, lon_deg,
/// altitude_m) where none is; time from the GPS's week; of pt, ps and dp the missing one. Rows are
/// those of the log. Throws OptionError for a choice of columns that are not there.
ReadFlight read_as(const Flight& flight, const LogChoice& choice);

}  // namespace sepcal
