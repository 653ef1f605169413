// SPDX-License-Identifier: BSD-3-Clause
// A flight as a CSV file.
#pragma once

#include "sepcal/detail/flight/output_file.hpp"
#include "sepcal/flight/flight.hpp"

namespace sepcal::files {

/// All columns and, where there are some, the labels; a NaN is an empty cell. Headers and labels
/// with a comma or a quote stand in quotes.
void write_flight(const Flight& flight, OutputFile& target);

}  // namespace sepcal::files
