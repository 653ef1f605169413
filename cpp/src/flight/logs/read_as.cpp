// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/flight/read_as.hpp"

#include "flight/logs/air_pressures.hpp"
#include "flight/logs/chosen_columns.hpp"
#include "flight/logs/gps_time.hpp"
#include "flight/logs/joined_clock.hpp"
#include "flight/logs/named_columns.hpp"
#include "flight/logs/quaternion_columns.hpp"
#include "flight/logs/shared_stamps.hpp"
#include "flight/logs/track_velocity.hpp"
#include "flight/logs/velocity_columns.hpp"

namespace sepcal {

ReadFlight read_as(const Flight& flight, const LogChoice& choice) {
  ReadFlight read{flight, flight.notes()};
  logs::choose_columns(read.flight, choice, read.notes);
  logs::name_columns(read.flight, read.notes);
  logs::derive_time(read.flight, read.notes);
  logs::spread_stamps(read.flight, read.notes);
  logs::join_clock(read.flight, read.notes);
  logs::convert_quaternion(read.flight, read.notes);
  logs::turn_heading(read.flight, read.notes);
  logs::turn_climb(read.flight, read.notes);
  logs::derive_from_track(read.flight, read.notes);
  read.velocity_is_of_positions = logs::derive_velocity(read.flight, read.notes);
  logs::derive_climb(read.flight, read.notes);
  logs::complete_pressures(read.flight, read.notes);
  return read;
}

}  // namespace sepcal
