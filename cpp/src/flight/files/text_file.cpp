// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/text_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "sepcal/error.hpp"

namespace sepcal::files {

std::string read_text_file(const std::string& file, std::string_view purpose) {
  std::error_code ignored;
  if (std::filesystem::status(file, ignored).type() == std::filesystem::file_type::not_found) {
    throw Error(fmt::format("{}: no such file to read {}", file, purpose));
  }
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (stream && stream.peek() != std::ifstream::traits_type::eof()) text << stream.rdbuf();
  // An empty file ends at once, which is no failure to read it.
  if (stream.bad() || (stream.fail() && !stream.eof()) || !text) {
    throw Error(fmt::format("{}: can't be read {}", file, purpose));
  }
  return text.str();
}

}  // namespace sepcal::files
