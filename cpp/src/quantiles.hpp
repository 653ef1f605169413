// SPDX-License-Identifier: BSD-3-Clause
// How many standard errors an interval reaches to either side, by its level.
#pragma once

namespace sepcal {

/// z with P(|Z| <= z) = level, Z standard normal. Throws Error unless 0 < level < 1.
double normal_reach(double level);

/// t with P(|T| <= t) = level, T Student's with `freedom` degrees, to about twelve digits; infinite
/// where there are none. Throws Error unless 0 < level < 1.
double student_reach(double level, double freedom);

}  // namespace sepcal
