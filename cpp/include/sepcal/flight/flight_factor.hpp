// SPDX-License-Identifier: BSD-3-Clause
// A calibrated flight as its fleet takes it: one triangle (fleet.hpp).
#pragma once

#include <string>
#include <vector>

#include "sepcal/fleet.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal {

/// Effects that the flight can show and that a fleet can test: linear ones of the probe's
/// catalogue, of every port with every channel, and of the calibration's own.
std::vector<std::string> list_fleet_candidates(const Calibration& calibration,
                                               const Flight& flight);

/// Throws Error for bad input, and as reduce() of the engine does.
FlightFactor reduce(const Calibration& calibration, const Flight& flight,
                    const ReduceOptions& options);

}  // namespace sepcal
