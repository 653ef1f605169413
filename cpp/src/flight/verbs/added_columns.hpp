// SPDX-License-Identifier: BSD-3-Clause
// A log as it stands with columns more.
#pragma once

#include <vector>

#include "sepcal/flight/flight.hpp"
#include "sepcal/flight/output_file.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal::verbs {

/// Copies every column and row of the file that the flight was read from and adds the columns; a
/// NaN is an empty cell. Throws Error for columns of those names that are there already.
void write_with_columns(const Flight& flight, const std::vector<CorrectedColumn>& columns,
                        OutputFile& target);

}  // namespace sepcal::verbs
