// SPDX-License-Identifier: BSD-3-Clause
// What a gap in time is: one definition for segments, runs of noise and what is said of a log. And
// gaps in a column, bridged.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace sepcal::base {

/// A gap is an interval > 5 (1 + 1e-6) usual ones: four lost samples of a regular record are
/// exactly five intervals, which rounding must not turn into a gap. The usual interval is the
/// median; of stamps that come in bursts it is the longest that is reached from there without a
/// jump by five, but one in twenty may be longer. Infinite where there is no interval.
double find_gap(std::vector<double> intervals);

/// The one in the middle of intervals, of an even number the upper one; there is at least one.
double usual_interval(std::vector<double> intervals);

/// A pass over intervals, each given to `visit`.
using PassOverIntervals = std::function<void(const std::function<void(double)>& visit)>;

/// The same of so many intervals that they are not copied: in memory that does not grow with them,
/// by some fifteen passes.
double find_gap(std::size_t count, const PassOverIntervals& pass);

/// Puts straight lines where values are NaN, from neighbour to neighbour by row; beyond the first
/// and the last one these stay. Nothing where all are NaN.
void bridge_gaps(std::span<double> values);

}  // namespace sepcal::base
