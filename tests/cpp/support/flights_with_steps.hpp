// SPDX-License-Identifier: BSD-3-Clause
// Flights in which something steps, and how far off its time is found.
#pragma once

#include <algorithm>
#include <cmath>

#include "flights_with_effects.hpp"

namespace sepcal::test {

inline const SizedEffect bias_step{"bias_step", {2.0, -1.0, 3.0}};

/// The longest time between two rows [s].
inline double row_interval(const SimulatedFlight& flight) {
  const auto& time = flight.column("time_s");
  double longest = 0.0;
  for (std::size_t k = 1; k < time.size(); ++k) longest = std::max(longest, time[k] - time[k - 1]);
  return longest;
}

inline double error_of(const Calibration& calibration, const SimulatedFlight& flight,
                       const char* name) {
  return std::abs(calibration.fit[name].value - flight.truth.at(name));
}

}  // namespace sepcal::test
