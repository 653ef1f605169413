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

}  // namespace sepcal::base
