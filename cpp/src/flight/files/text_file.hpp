// SPDX-License-Identifier: BSD-3-Clause
// A small text file, read whole.
#pragma once

#include <string>
#include <string_view>

namespace sepcal::files {

/// The file's bytes; `purpose` ends the messages: "as a truth file". Throws Error where the file
/// isn't there, is a folder or can't be read.
std::string read_text_file(const std::string& file, std::string_view purpose);

}  // namespace sepcal::files
