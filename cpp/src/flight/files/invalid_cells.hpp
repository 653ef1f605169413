// SPDX-License-Identifier: BSD-3-Clause
// Cells of a flight that are no finite numbers, and what a message says of them.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "flight/files/units.hpp"
#include "sepcal/flight/flight.hpp"

namespace sepcal::files {

/// The first of `rows` in which the column holds no finite number, as it stands (without a unit) or
/// converted from `unit`; nullptr where there is none.
const std::size_t* find_invalid_row(std::span<const std::size_t> rows, const Flight::Column& column,
                                    const Unit* unit);

/// "holds 'n/a'", "is empty" or, from arrays, "holds nan"; "holds 1e+308, too large to convert".
std::string describe_cell(const Flight::Column& column, std::size_t row);

}  // namespace sepcal::files
