// SPDX-License-Identifier: BSD-3-Clause
// Numbers that may be undefined, as pages show them.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace sepcal::text {

/// "-" for NaN.
inline std::string defined(double value, const char* format) {
  return std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), value);
}

}  // namespace sepcal::text
