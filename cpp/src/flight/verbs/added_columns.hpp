// SPDX-License-Identifier: BSD-3-Clause
// A log as it stands with columns more.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "sepcal/detail/flight/output_file.hpp"
#include "sepcal/flight/flight.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal::verbs {

/// Copies every column and row of the file that the flight was read from and adds the columns; a
/// NaN is an empty cell. Throws Error for columns of those names that are there already.
void write_with_columns(const Flight& flight, const std::vector<CorrectedColumn>& columns,
                        OutputFile& target);

/// The columns of rows [first, last).
using ColumnsOfRows =
    std::function<std::vector<CorrectedColumn>(std::size_t first, std::size_t last)>;

/// The same with columns that are asked for as the rows are written, `piece` rows at a time.
void write_with_columns(const Flight& flight, const std::vector<std::string>& headers,
                        std::size_t piece, const ColumnsOfRows& columns_of, OutputFile& target);

}  // namespace sepcal::verbs
