// SPDX-License-Identifier: BSD-3-Clause
// A flight as a CSV file.
#pragma once

#include <cstddef>
#include <string>

#include "sepcal/detail/flight/output_file.hpp"
#include "sepcal/flight/flight.hpp"

namespace sepcal::files {

/// The names of all columns and, where there are labels, "maneuver", as a line of a CSV without its
/// end.
std::string written_header(const Flight& flight);

/// A row of them; a NaN is an empty cell. Headers and labels with a comma or a quote stand in
/// quotes.
void write_row(std::string& line, const Flight& flight, std::size_t row);

/// The header and all rows.
void write_flight(const Flight& flight, OutputFile& target);

}  // namespace sepcal::files
