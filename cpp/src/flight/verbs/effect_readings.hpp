// SPDX-License-Identifier: BSD-3-Clause
// Readings put right by what a calibration knows of its effects: delays of the inputs first, then
// each port's total row by row, then delays of all that the sensor measures. Effects on the world
// around the instrument (the wind, the navigation) do not change what a reading means and need no
// driver here.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/calibration.hpp"

namespace sepcal::verbs {

/// The corrected columns of every row of the flight, NaN where there is nothing to correct or a
/// driver is no number; `readings` are Probe::read()'s, whose rows without a correction are then no
/// longer valid. Throws Error for a driver that the flight doesn't log.
std::vector<CorrectedColumn> correct_with_effects(const Calibration& calibration,
                                                  const Flight& flight, ProbeReadings& readings);

/// Of a model with a state what it makes of a flight, in the rows that a fit takes of it; of
/// another flight than the fitted one the log has the outputs too, which tell the initial states.
/// Fills in the readings' valid rows and notes. Throws Error as a fit of the flight does.
std::vector<CorrectedColumn> predict_along(const Calibration& given, const Flight& flight,
                                           ProbeReadings& readings);

}  // namespace sepcal::verbs
