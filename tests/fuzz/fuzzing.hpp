// SPDX-License-Identifier: BSD-3-Clause
// What every fuzzer holds a reader to: it refuses by Error alone, in one printable line. A property
// that doesn't hold ends the process, and libFuzzer keeps the input.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "sepcal/error.hpp"

namespace sepcal::fuzz {

inline void require(bool holds, std::string_view property) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %.*s\n", static_cast<int>(property.size()), property.data());
  std::abort();
}

/// By another judge than sepcal's own: nlohmann::json writes no string that is not UTF-8.
inline bool is_utf8(const std::string& text) {
  try {
    return !nlohmann::json(text).dump().empty();
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

inline void check_message(const std::string& message) {
  require(!message.empty(), "a message says something");
  for (const char c : message) {
    const auto byte = static_cast<unsigned char>(c);
    require(byte >= 0x20 && byte != 0x7F, "a message is one line without control characters");
  }
  require(is_utf8(message), "a message is UTF-8");
}

/// Runs `act`; false where it refuses. What else it may throw is a finding.
template <class Act>
bool accepts(const Act& act) {
  try {
    act();
    return true;
  } catch (const Error& error) {
    check_message(error.what());
    return false;
  }
}

inline std::string_view text_of(const std::uint8_t* bytes, std::size_t size) {
  return {reinterpret_cast<const char*>(bytes), size};
}

}  // namespace sepcal::fuzz
