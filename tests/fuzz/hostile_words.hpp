// SPDX-License-Identifier: BSD-3-Clause
// Hostile names out of the fuzzer's bytes, what plain names stand in their place, and a judge of
// printed text that shares no code with sepcal's.
#pragma once

#include <fuzzer/FuzzedDataProvider.h>

#include <array>
#include <limits>
#include <string>
#include <string_view>

#include "fuzzing.hpp"

namespace sepcal::fuzz {

/// A code point and how many bytes it takes; `length` 0 where the bytes are no UTF-8 (RFC 3629).
struct Decoded {
  char32_t code = 0;
  std::size_t length = 0;
};

inline Decoded decode(std::string_view text) {
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(text[at]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return {first, 1};
  const std::size_t length = first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  if (length == 0 || first > 0xF4 || text.size() < length) return {};
  char32_t code = first & (0x7FU >> length);
  for (std::size_t at = 1; at < length; ++at) {
    if ((byte(at) & 0xC0U) != 0x80U) return {};
    code = code << 6U | (byte(at) & 0x3FU);
  }
  constexpr std::array<char32_t, 5> least{0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < least.at(length) || is_surrogate || code > 0x10FFFF) return {};
  return {code, length};
}

/// Unicode's general categories Cc, Zl and Zp, and its property Bidi_Control (PropList.txt).
inline bool may_not_be_printed(char32_t code) {
  const auto within = [code](char32_t first, char32_t last) {
    return code >= first && code <= last;
  };
  return within(0x00, 0x1F) || within(0x7F, 0x9F) || code == 0x061C || within(0x200E, 0x200F) ||
         within(0x2028, 0x202E) || within(0x2066, 0x2069);
}

/// The same word without what must not be printed: of as many bytes, with the same blanks and the
/// same punctuation, so that whatever is decided by a name is decided alike. A tab becomes a blank
/// but after a semicolon: "; " parts the sentences of a message.
inline std::string plain_of(std::string_view word) {
  std::string plain;
  for (std::size_t at = 0; at < word.size();) {
    const auto [code, length] = decode(word.substr(at));
    const std::size_t taken = length == 0 ? 1 : length;
    if (length == 0 || may_not_be_printed(code)) {
      const bool is_blank = word[at] == '\t' && !plain.ends_with(';');
      plain += is_blank ? std::string(1, ' ') : std::string(taken, 'x');
    } else {
      plain += word.substr(at, taken);
    }
    at += taken;
  }
  return plain;
}

/// UTF-8 in which nothing but the line ends steers a terminal.
inline void check_printed(std::string_view page) {
  for (std::size_t at = 0; at < page.size();) {
    const auto [code, length] = decode(page.substr(at));
    require(length > 0, "what is printed is UTF-8");
    require(code == '\n' || !may_not_be_printed(code), "what is printed steers no terminal");
    at += length;
  }
}

/// Names and numbers, one after the other, while the bytes last.
class Hostile {
 public:
  Hostile(const std::uint8_t* data, std::size_t size) : bytes_(data, size) {}

  std::string word() {
    constexpr std::size_t longest = 200;
    return bytes_.ConsumeRandomLengthString(longest);
  }

  /// From 0 to `last`.
  int choice(int last) { return bytes_.ConsumeIntegralInRange(0, last); }

  /// Mostly what it was: else what a calibration's file can hold, and what arithmetic can make.
  double number(double was) {
    using Limits = std::numeric_limits<double>;
    constexpr std::array hostile{0.0,    -0.0,    1e308,
                                 -1e308, 1e-308,  Limits::denorm_min(),
                                 1e22,   -1e-300, Limits::quiet_NaN(),
                                 1.0,    -1.0,    Limits::infinity()};
    const auto at = static_cast<std::size_t>(choice(63));
    return at < hostile.size() ? hostile.at(at) : was;
  }

 private:
  FuzzedDataProvider bytes_;
};

}  // namespace sepcal::fuzz
