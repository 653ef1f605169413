// SPDX-License-Identifier: BSD-3-Clause
// What a calibration is joint of, as JSON, and the departures of its flights.
#pragma once

#include "flight/json/output_values.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal::json {

/// {own, flights, departures}; of a calibration that is joint.
Json write_joint(const Calibration& calibration);

/// Makes the calibration's probe that of the joint fit, and takes its departures.
void read_joint(const Json& object, Calibration& calibration);

}  // namespace sepcal::json
