// SPDX-License-Identifier: BSD-3-Clause
// A driver counted from an origin. A float has 24 bits: of a time of 1.76e9 s it holds each 128th
// second, of the same time less 1.76e9 s each microsecond. Where a driver stays far from zero the
// caller therefore takes the origin away before the driver becomes a float.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/quantity.hpp"

namespace sepcal::exporting {

/// What the name of an argument less its origin has behind it.
inline constexpr std::string_view origin_suffix = "_less_origin";

/// 0 where |driver| stays within `far` = 4 times what it changes over, which costs 2.4e-7 of that;
/// else a number of few decimals near the middle, from which no value is further than 3/4 of that.
double origin_of(const Interval& range);

/// "(1764000000.0 + unix_s_less_origin)"; the expression itself where there is no origin.
std::string whole_of(const std::string& less_origin, double origin);

/// A number as code in double has it.
std::string number_text(double value);

/// Coefficients c of (origin + d)^power = sum_j c_j d^j, `power` + 1 of them, lowest first.
std::vector<double> powers_about(double origin, int power);

/// "c[first] + d * (c[first + 1] + ...)", up to c[last], by Horner's rule.
std::string horner(const std::string& c, std::size_t first, std::size_t last, const std::string& d);

}  // namespace sepcal::exporting
