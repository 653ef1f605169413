// SPDX-License-Identifier: BSD-3-Clause
// Cells of a flight that are no readings, and what a message says of them.
#pragma once

#include <cmath>
#include <cstddef>
#include <string>

#include "flight/files/units.hpp"
#include "sepcal/flight/flight.hpp"

namespace sepcal::files {

/// Of a larger one the square, which every fit forms, may be beyond a double.
constexpr double largest_reading = 1e150;

/// Whether it is a number that can be computed with.
inline bool is_reading(double value) { return std::abs(value) <= largest_reading; }

/// Whether the column holds a reading there, as it stands (without a unit) or converted from
/// `unit`.
bool is_valid(const Flight::Column& column, const Unit* unit, std::size_t row);

/// "holds 'n/a'", "is empty" or, from arrays, "holds nan"; "holds 1e+308, too large to compute
/// with".
std::string describe_cell(const Flight::Column& column, std::size_t row);

}  // namespace sepcal::files
