// SPDX-License-Identifier: BSD-3-Clause
// Which rows of a flight a fit takes. It travels in a calibration, so that later verbs take the
// same rows of the same flight, and rows of the same kind of another one.
#pragma once

#include <string>
#include <vector>

namespace sepcal {

struct RowChoice {
  /// Drop rows with a bad cell in a needed column instead of refusing them.
  bool drop_invalid = false;

  /// Slow columns, by quantity ("airspeed") or whole header ("airspeed_kt"): of the rows between
  /// their samples, held or interpolated, none is taken. Of several columns the slowest counts;
  /// where some are about as slow, a row in which any of these was sampled.
  std::vector<std::string> drop_repeats = {};

  bool operator==(const RowChoice&) const = default;
};

}  // namespace sepcal
