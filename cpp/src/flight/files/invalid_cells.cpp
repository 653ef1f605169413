// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/invalid_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sepcal::files {

bool is_valid(const Flight::Column& column, const Unit* unit, std::size_t row) {
  const double value = column.values[row];
  return is_reading(unit == nullptr ? value : unit->convert(value));
}

std::string describe_cell(const Flight::Column& column, std::size_t row) {
  const double value = column.values[row];
  if (std::isfinite(value)) return fmt::format("holds {}, too large to compute with", value);
  if (!column.first_text) return fmt::format("holds {}", value);
  if (column.first_text->row != row) return "holds text";
  std::string_view text = column.first_text->text;
  if (text.empty()) return "is empty";
  std::size_t end = std::min<std::size_t>(text.size(), 40);
  const auto continues = [&](char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; };
  while (end < text.size() && continues(text[end])) --end;  // never through a UTF-8 character
  return fmt::format("holds '{}'", text.substr(0, end));
}

}  // namespace sepcal::files
