// SPDX-License-Identifier: BSD-3-Clause
// What a vehicle's correction lacks of a calibration's, row by row over a flight.
#pragma once

#include "flight/export/held.hpp"
#include "flight/export/held_airspeed.hpp"

namespace sepcal::exporting {

/// `full` is the calibration on the flight, `refitted` what the vehicle's is taken from.
Approximation field_approximation(const Calibration& full, const Calibration& refitted,
                                  const HeldField& held, const Flight& flight);
Approximation airspeed_approximation(const Calibration& full, const FittedAirspeed& fitted,
                                     const TubeReader& reader, const Flight& flight);

/// Of a header: the two calibrations' corrected columns.
Approximation refit_approximation(const Calibration& full, const Calibration& refitted,
                                  const Flight& flight);

}  // namespace sepcal::exporting
