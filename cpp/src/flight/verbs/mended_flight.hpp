// SPDX-License-Identifier: BSD-3-Clause
// A flight of which no effect follows a code, a glitch or an empty cell, and what is to be left out
// of it before the columns that are measured are believed.
#pragma once

#include <string>
#include <vector>

#include "flight/probes/quantities.hpp"
#include "sepcal/detail/flight/log_choice.hpp"
#include "sepcal/flight/flight.hpp"

namespace sepcal::verbs {

/// Rows that are to be left out.
struct RowsToLeave {
  std::string condition = {};  // on the others, as --where takes it; empty where there are none
  std::string columns = {};    // whose readings are none there
};

struct MendedFlight {
  Flight flight;  // columns that drive effects: values between their neighbours
  std::vector<std::string> bridged = {};  // a line a column with rows that were no readings
  std::vector<std::string> filled = {};   // a line a column with empty cells alone
  RowsToLeave measured = {};              // where a measured column has no reading
  RowsToLeave all = {};                // and where a driver stood still, over which nothing bridges
  std::vector<std::string> slow = {};  // the columns that are sampled in the fewest rows
  bool loss_helps = true;  // the measured ones are off, but not as far as a code, nor for long
};

/// `flight` as read_as() gives it; the rows that `choice` does not take stay as they are, and so
/// does a flight that may be longer than memory. Empty cells are filled where they are at most one
/// in twenty. Throws Error as probes::rows_taken().
MendedFlight mend(const probes::ModelQuantities& model, const Flight& flight,
                  const LogChoice& choice);

}  // namespace sepcal::verbs
