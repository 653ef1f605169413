// SPDX-License-Identifier: BSD-3-Clause
// Numbers that may be undefined, as pages show them.
#pragma once

#include <cmath>

#include "base/page.hpp"

namespace sepcal::text {

/// "-" for NaN.
inline base::Page defined(double value, fmt::format_string<double> format) {
  return std::isnan(value) ? base::Page("-") : base::page(format, value);
}

}  // namespace sepcal::text
