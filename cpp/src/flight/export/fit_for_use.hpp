// SPDX-License-Identifier: BSD-3-Clause
// Whether a calibration is fit to fly with.
#pragma once

#include <string>

#include "sepcal/flight/calibration.hpp"

namespace sepcal::exporting {

/// Throws Error in one line where the fit did not converge, leaves something undetermined, or has a
/// parameter at its bound. `which` opens the message: "the calibration".
void check_fit_for_use(const Calibration& calibration, const std::string& which);

}  // namespace sepcal::exporting
