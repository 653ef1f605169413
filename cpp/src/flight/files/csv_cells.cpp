// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/csv_cells.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace sepcal::files {

void append_number(std::string& line, double value) {
  if (std::isnan(value)) return;
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  line.append(text.data(), end);
}

void append_text(std::string& line, std::string_view text) {
  const bool is_quoted = text.find_first_of(",\"") != std::string_view::npos ||
                         text.starts_with(' ') || text.ends_with(' ');
  if (is_quoted) line += '"';
  for (const char c : text) line.append(is_quoted && c == '"' ? 2 : 1, c);
  if (is_quoted) line += '"';
}

std::string join_cells(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) {
    if (&cell != &cells.front()) line += ',';
    append_text(line, cell);
  }
  return line;
}

}  // namespace sepcal::files
