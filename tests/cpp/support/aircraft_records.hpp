// SPDX-License-Identifier: BSD-3-Clause
// Simulated flights of an aircraft as records: headers without units.
#pragma once

#include <string>

#include "sepcal/record.hpp"
#include "sepcal/simulation/aircraft.hpp"

namespace sepcal::test {

inline Record record_of(const SimulatedFlight& flight) {
  Record record;
  for (const SimulatedColumn& column : flight.columns) {
    record.add(column.name.substr(0, column.name.rfind('_')), column.values);
  }
  return record;
}

/// Every reading is exact.
inline AircraftTruth without_noise(AircraftTruth truth = {}) {
  for (auto& [channel, deviation] : truth.noise) deviation = 0.0;
  return truth;
}

}  // namespace sepcal::test
