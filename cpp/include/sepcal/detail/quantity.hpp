// SPDX-License-Identifier: BSD-3-Clause
// A named physical quantity: the element of a model's four tables. Everything that people read or
// write (CSV headers, report labels, keys of bounds, Python names) comes from these tables.
#pragma once

#include <limits>
#include <string_view>

namespace sepcal {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

struct Interval {
  double lower = -infinity;
  double upper = infinity;
};

/// Name and unit of an input, an output or a parameter, as a model declares it at compile time.
/// Parameters may carry the bounds that apply when the caller gives none, in the same unit.
struct Quantity {
  std::string_view name;
  std::string_view unit;
  double lower = -infinity;
  double upper = infinity;
  double absent = not_a_number;  // of an input: its value where a record has no such column
};

/// An input that is zero unless an effect drives it: a place where a model can be corrected.
constexpr Quantity port(std::string_view name, std::string_view unit) {
  return {name, unit, -infinity, infinity, 0.0};
}

}  // namespace sepcal
