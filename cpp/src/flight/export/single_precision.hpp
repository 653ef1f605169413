// SPDX-License-Identifier: BSD-3-Clause
// What changes of a header's text where it computes in float: types, literals, functions of math.h.
#pragma once

#include <string>
#include <string_view>

namespace sepcal::exporting {

/// The nearest float, as a double. Throws Error for a number beyond what a float holds.
double to_single(double value);

/// Statements in double as statements in float: double, 0.5 and sqrt() become float, 0.5f and
/// sqrtf(). Comments stay as they are.
std::string in_single_precision(std::string_view code);

}  // namespace sepcal::exporting
