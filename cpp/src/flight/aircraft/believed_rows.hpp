// SPDX-License-Identifier: BSD-3-Clause
// What of an aircraft's log is believed: codes, glitches and frozen rows are told, bridged where a
// state is carried over them or an effect follows them, and left out by who judges a fit.
#pragma once

#include <string>
#include <vector>

#include "flight/checks/suspect_rows.hpp"
#include "sepcal/flight/aircraft.hpp"

namespace sepcal::aircraft_log {

struct BelievedFlight {
  Flight flight;                        // bridged
  checks::RowList left_out = {};        // by each verb: a code there is no reading
  std::vector<std::string> notes = {};  // a line a column and kind
};

/// `flight` as read_as() gives it. Throws OptionError as the choice's condition and times do.
BelievedFlight believe(const Flight& flight, AircraftModel model, const LogChoice& choice);

/// The fit of the rows that are readings, with a note of what was left out; of another flight than
/// its own it is held, and its choice of rows is narrower. The fit as it is where all rows seem to
/// be readings, or where the others can't be fitted.
AircraftFit without_suspects(const AircraftFit& fitted, const Flight& flight,
                             std::vector<std::string>& notes);

}  // namespace sepcal::aircraft_log
