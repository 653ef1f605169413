// SPDX-License-Identifier: BSD-3-Clause
// Squared lengths outside this range have lost digits to underflow or are about to overflow.
#pragma once

namespace sepcal::numerics {

inline constexpr double smallest_safe_square = 1e-200;
inline constexpr double largest_safe_square = 1e200;

}  // namespace sepcal::numerics
