// SPDX-License-Identifier: BSD-3-Clause
// The normal distribution, and how many standard errors an interval reaches to either side.
#pragma once

namespace sepcal::numerics {

/// z with P(|Z| <= z) = level, Z standard normal. Throws Error unless 0 < level < 1.
double normal_reach(double level);

/// Phi(x), the standard normal distribution.
double normal_probability(double x);

/// Phi^-1(p), p in (0, 1), |error| < 1e-14 max(1, |Phi^-1(p)|): Newton steps on erfc.
double normal_quantile(double p);

/// t with P(|T| <= t) = level, T Student's with `freedom` degrees, to about twelve digits; infinite
/// where there are none. Throws Error unless 0 < level < 1.
double student_reach(double level, double freedom);

}  // namespace sepcal::numerics
