// SPDX-License-Identifier: BSD-3-Clause
// The lines above a table's rows: which of them names the columns, which gives their units.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sepcal::files {

/// "m/s", "[deg]", "ft Baro", "hh:mm:ss", "-": what stands in a row of units.
bool is_unit_like(std::string_view cell);

/// A line that may be one of the head's, cut into cells.
struct HeadLine {
  std::size_t line = 0;  // counted from 0
  std::vector<std::string> cells;
};

struct TableHead {
  const HeadLine* names = nullptr;
  const HeadLine* units = nullptr;
};

/// Of the lines above the rows, in their order, the one that names columns, and the one of units.
TableHead choose_head(const std::vector<HeadLine>& lines);

/// Whether one of them is what a quantity is called, by sepcal or by others.
bool names_quantities(const std::vector<std::string>& cells);

/// "vn (m/s)"; the name alone where the unit says nothing or the name says one itself, "vn_mps".
std::string with_unit(const std::string& name, std::string_view unit);

/// Whether the name ends with a unit, and with another one than `unit` is.
bool contradicts_unit(std::string_view name, std::string_view unit);

}  // namespace sepcal::files
