// SPDX-License-Identifier: BSD-3-Clause
#include "base/escaping.hpp"

#include <algorithm>
#include <array>

#include "base/utf8.hpp"

namespace sepcal::base {
namespace {

/// U+200E and U+200F, U+2028 to U+202E, U+2066 to U+2069: marks and ends of lines and directions.
bool is_separator_or_direction(std::string_view character) {
  if (character.size() != 3 || character.front() != '\xE2') return false;
  const auto second = static_cast<unsigned char>(character[1]);
  const auto third = static_cast<unsigned char>(character[2]);
  if (second == 0x80) return third == 0x8E || third == 0x8F || (third >= 0xA8 && third <= 0xAE);
  return second == 0x81 && third >= 0xA6 && third <= 0xA9;
}

/// Whether a character ends a line or steers a terminal: C0, DEL, C1, U+061C, and the above.
bool is_control(std::string_view character) {
  const auto first = static_cast<unsigned char>(character.front());
  if (character.size() == 1) return first < 0x20 || first == 0x7F;
  if (character.size() == 2) {
    const auto second = static_cast<unsigned char>(character[1]);
    return (first == 0xC2 && second < 0xA0) || (first == 0xD8 && second == 0x9C);
  }
  return is_separator_or_direction(character);
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

/// Puts a blank between the characters of a pair wherever it stands.
void part(std::string& text, std::string_view pair) {
  for (std::size_t at = text.find(pair); at != std::string::npos; at = text.find(pair, at + 1)) {
    text.insert(at + 1, 1, ' ');
  }
}

}  // namespace

std::string in_line(std::string_view text) {
  std::string line;
  line.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    const std::string_view character = text.substr(at, length == 0 ? 1 : length);
    if (length == 0 || is_control(character)) {
      append_escaped(line, character);
    } else {
      line += character;
    }
    at += character.size();
  }
  return line;
}

std::string in_c_comment(std::string_view text) {
  std::string line = in_line(text);
  for (const std::string_view pair : {"*/", "/*", "??"}) part(line, pair);
  if (line.ends_with('\\')) line += "x5c";
  return line;
}

/// Within '...' the shell takes everything but ' as it is; $'...' takes what in_line() writes.
std::string in_shell(std::string_view text) {
  constexpr std::string_view plain = "%+,-./:=@_";
  const bool is_plain = std::ranges::all_of(text, [&](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
           plain.find(c) != std::string_view::npos;
  });
  if (is_plain && !text.empty()) return std::string(text);
  const bool is_printable = in_line(text) == text;
  std::string word = is_printable ? "'" : "$'";
  for (const char c : text) {
    if (c == '\'') {
      word += is_printable ? "'\\''" : "\\'";
    } else if (c == '\\' && !is_printable) {
      word += "\\\\";
    } else {
      word += c;
    }
  }
  return in_line(word) + "'";
}

std::string file_in_shell(std::string_view name) {
  return name.starts_with('-') ? in_shell("./" + std::string(name)) : in_shell(name);
}

std::string as_typed(const std::string& name) {
  std::string option = "--" + name;
  std::ranges::replace(option, '_', '-');
  return option;
}

}  // namespace sepcal::base
