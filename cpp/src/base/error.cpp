// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/error.hpp"

#include <string_view>

#include "base/utf8.hpp"

namespace sepcal {

using namespace base;  // this room's own

namespace {

/// Whether a character ends a line or steers a terminal: C0, DEL, C1, U+2028 and U+2029.
bool is_control(std::string_view character) {
  const auto first = static_cast<unsigned char>(character.front());
  if (character.size() == 1) return first < 0x20 || first == 0x7F;
  if (character.size() == 2)
    return first == 0xC2 && static_cast<unsigned char>(character[1]) < 0xA0;
  return character == "\xE2\x80\xA8" || character == "\xE2\x80\xA9";
}

void append_escaped(std::string& line, std::string_view bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  if (bytes == "\n" || bytes == "\r" || bytes == "\t") {
    line += bytes == "\n" ? "\\n" : bytes == "\r" ? "\\r" : "\\t";
    return;
  }
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    line += {'\\', 'x', digits[byte >> 4U], digits[byte & 0xFU]};
  }
}

std::string one_line(std::string_view message) {
  std::string line;
  line.reserve(message.size());
  for (std::size_t at = 0; at < message.size();) {
    const std::size_t length = utf8_length(message, at);
    const std::string_view character = message.substr(at, length == 0 ? 1 : length);
    if (length == 0 || is_control(character)) {
      append_escaped(line, character);
    } else {
      line += character;
    }
    at += character.size();
  }
  return line;
}

}  // namespace

Error::Error(const std::string& message) : std::runtime_error(one_line(message)) {}

}  // namespace sepcal
