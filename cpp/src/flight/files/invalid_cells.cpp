// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/invalid_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "flight/files/number_text.hpp"
#include "flight/files/table_head.hpp"

namespace sepcal::files {
namespace {

/// "14.2 m/s": where other cells are plain numbers, or in another unit.
bool has_unit(std::string_view text) {
  const std::size_t digits = text.find_last_of("0123456789");
  return digits != std::string_view::npos && look_at_number(text.substr(0, digits + 1)).is_number &&
         is_unit_like(text.substr(digits + 1));
}

}  // namespace

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
  return fmt::format("holds '{}'{}", text.substr(0, end),
                     has_unit(text) ? ", with a unit of its own" : "");
}

}  // namespace sepcal::files
