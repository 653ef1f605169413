// SPDX-License-Identifier: BSD-3-Clause
// Numbers as the world writes them: with a decimal comma, groups of thousands, a typographic minus.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace sepcal::files {

/// What a cell's number shows of how numbers are written.
struct NumberLook {
  bool is_number = false;
  bool decimal_comma = false;  // "14,2"
  bool either = false;         // "14,200": a decimal comma or a group of thousands
  bool is_odd = false;         // with another sign of minus, or "1.0D+02" of Fortran
  std::string groups = {};     // marks that group digits for sure: "," of "1,234,567"
};

NumberLook look_at_number(std::string_view cell);

/// What parts decimals, and what parts thousands.
struct NumberMarks {
  char decimal = '.';
  std::string groups = {};

  /// Whether numbers are written as C++ writes them.
  bool is_plain() const { return decimal == '.' && groups.empty(); }
};

/// The finite number that `cell` is under these marks, where digits that are parted stand in groups
/// of three; as parse_number() where the marks are plain, but with an exponent behind D too.
std::optional<double> parse_number_as(std::string_view cell, const NumberMarks& marks);

/// "2.50": 2, "7": 0; -1 of what is no number.
int count_decimals(std::string_view cell, char decimal);

}  // namespace sepcal::files
