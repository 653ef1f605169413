// SPDX-License-Identifier: BSD-3-Clause
// Columns of a log that are logged at other times than the measured one, in its rows.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "flight/logs/slow_column.hpp"
#include "sepcal/flight/flight.hpp"

namespace sepcal::logs {

/// The rows of what is measured.
struct MeasuredRows {
  std::vector<std::size_t> rows;     // in the log's order
  std::vector<std::string> headers;  // that hold a reading in each of them
};

/// Gives every other column that is empty in some of those rows a value there, where it has samples
/// on both sides (joined_rates.hpp of the public headers says which); smoothed, it has that value
/// in all of them, else it stays where it was logged. Notes say what was brought. Throws
/// OptionError where no time was logged, and of a log on disc.
void join_rates(Flight& flight, const MeasuredRows& measured, Joining joining,
                std::vector<std::string>& notes);

}  // namespace sepcal::logs
