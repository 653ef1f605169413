// SPDX-License-Identifier: BSD-3-Clause
// Numbers as sentences say them.
#pragma once

#include <cstdio>
#include <string>

namespace sepcal::base {

/// Three digits: "0.0123", "4.57e+05".
inline std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

/// A time [s], also one since 1970, to a millisecond: "75.7333", "1718874636.100".
inline std::string stamp(double seconds) {
  char text[32];
  const char* format = seconds < 1e5 && seconds > -1e5 ? "%.6g" : "%.3f";
  std::snprintf(text, sizeof text, format, seconds);
  return text;
}

}  // namespace sepcal::base
