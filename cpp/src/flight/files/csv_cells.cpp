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

}  // namespace sepcal::files
