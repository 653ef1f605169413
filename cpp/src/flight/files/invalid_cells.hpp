// SPDX-License-Identifier: BSD-3-Clause
// Cells of a flight that are no finite numbers, and what a message says of them.
#pragma once

#include <cstddef>
#include <string>

#include "flight/files/units.hpp"
#include "sepcal/flight/flight.hpp"

namespace sepcal::files {

/// Whether the column holds a finite number there, as it stands (without a unit) or converted from
/// `unit`.
bool is_valid(const Flight::Column& column, const Unit* unit, std::size_t row);

/// "holds 'n/a'", "is empty" or, from arrays, "holds nan"; "holds 1e+308, too large to convert".
std::string describe_cell(const Flight::Column& column, std::size_t row);

}  // namespace sepcal::files
