// SPDX-License-Identifier: BSD-3-Clause
// Two logs of one flight, each with rows and a clock of its own, as one log: the rows are those of
// the sensor that is measured, and what the other log has is brought to them.
#pragma once

#include <string>

#include "sepcal/flight/flight.hpp"

namespace sepcal {

struct RateJoining {
  /// What stands in a row: "smooth", a parabola fitted to the samples about it; "linear", the
  /// straight line between two samples; "held", the earlier of them. A line has half the noise
  /// between two samples that it has at them, which pulls an estimate of the clocks' offset; a
  /// parabola has the same noise everywhere.
  std::string how = "smooth";

  /// What is added to the other log's time [s].
  double offset = 0.0;
};

/// Rows and columns of `measured`, and the columns of `other` at these rows, both as a probe reads
/// them: under sepcal's names, velocity from speed and track, attitude from a quaternion. Nothing
/// goes beyond the samples of a column or across its gaps (five usual intervals). Rows outside of
/// the other log are left out; a cell in a gap is NaN. Angles (headers that end in _deg or _rad) go
/// the short way round. Of a column that both have, that of `measured` stays. Notes say all of
/// this. Both need a column of time, in any unit. Throws Error where there is none, where it runs
/// back, and where the clocks have no time in common; OptionError for another `how` or an offset
/// that is no number.
Flight join_rates(const Flight& measured, const Flight& other, const RateJoining& options = {});

}  // namespace sepcal
