// SPDX-License-Identifier: BSD-3-Clause
// Numbers as cells of a CSV file.
#pragma once

#include <string>

namespace sepcal::files {

/// The shortest text that reads back as the same double; nothing for NaN.
void append_number(std::string& line, double value);

}  // namespace sepcal::files
