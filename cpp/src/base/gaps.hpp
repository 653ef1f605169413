// SPDX-License-Identifier: BSD-3-Clause
// What a gap in time is: one definition for segments, runs of noise and what is said of a log.
#pragma once

#include <vector>

namespace sepcal::base {

/// A gap is an interval > 5 (1 + 1e-6) usual ones: four lost samples of a regular record are
/// exactly five intervals, which rounding must not turn into a gap. The usual interval is the
/// median; of stamps that come in bursts it is the longest that is reached from there without a
/// jump by five, but one in twenty may be longer. Infinite where there is no interval.
double find_gap(std::vector<double> intervals);

}  // namespace sepcal::base
