// SPDX-License-Identifier: BSD-3-Clause
// UTF-8 against RFC 3629, section 3: every code point is encoded here by its table of bits.
#include "base/utf8.hpp"

#include <doctest/doctest.h>

#include <string>

namespace utf8_test {

using sepcal::base::utf8_length;

namespace {

/// `length` bytes for a code point, whether that is the shortest form or not.
std::string encode(unsigned point, std::size_t length) {
  if (length == 1) return {static_cast<char>(point)};
  std::string bytes(length, '\0');
  for (std::size_t i = length - 1; i > 0; --i, point >>= 6U) {
    bytes[i] = static_cast<char>(0x80U | (point & 0x3FU));
  }
  bytes[0] = static_cast<char>((0xF00U >> length) | point);
  return bytes;
}

std::size_t shortest(unsigned point) {
  return point < 0x80 ? 1 : point < 0x800 ? 2 : point < 0x10000 ? 3 : 4;
}

}  // namespace

TEST_CASE("every code point but the surrogates, in its shortest form alone") {
  std::size_t wrong = 0;
  for (unsigned point = 0; point < 0x200000; ++point) {
    const bool is_character = point < 0x110000 && (point < 0xD800 || point > 0xDFFF);
    for (std::size_t length = shortest(point); length <= 4; ++length) {
      const std::size_t expected = is_character && length == shortest(point) ? length : 0;
      if (utf8_length(encode(point, length), 0) != expected) ++wrong;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a character that is cut off or broken is none, and its place in the text counts") {
  const std::string text = "a\xE2\x82\xAC";
  CHECK(utf8_length(text, 0) == 1);
  CHECK(utf8_length(text, 1) == 3);
  CHECK(utf8_length(text, 2) == 0);
  CHECK(utf8_length(std::string_view(text).substr(0, 3), 1) == 0);
  CHECK(utf8_length("\xC3(", 0) == 0);
  CHECK(utf8_length("\xF0\x9F\x9B\xC3\xA9", 0) == 0);
  CHECK(utf8_length("\xFF", 0) == 0);
}

}  // namespace utf8_test
