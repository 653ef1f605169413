// SPDX-License-Identifier: BSD-3-Clause
// A flight brought to the model of a calibration that is there already: its effects mean what they
// meant on the flight that was fitted.
#pragma once

#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/probe_effects.hpp"

namespace sepcal::verbs {

/// Throws Error as prepare_with_effects() does, and where the calibration's parameters are not
/// those of its model with its effects.
EffectiveFlight prepare_calibrated(const Calibration& calibration, const Flight& flight);

/// Adds a note where the flight is another file than the calibration was fitted to: its errors are
/// no longer those of a fit.
void note_other_flight(const Calibration& calibration, const Flight& flight,
                       std::vector<std::string>& notes);

}  // namespace sepcal::verbs
