// SPDX-License-Identifier: BSD-3-Clause
// Numbers and texts as cells of a CSV file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sepcal::files {

/// The shortest text that reads back as the same double; nothing for NaN.
void append_number(std::string& line, double value);

/// The text, in quotes where it needs them to read back.
void append_text(std::string& line, std::string_view text);

/// The cells with commas between them, in quotes where they need them.
std::string join_cells(const std::vector<std::string>& cells);

}  // namespace sepcal::files
