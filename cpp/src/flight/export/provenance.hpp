// SPDX-License-Identifier: BSD-3-Clause
// What an exported file says of itself at its head.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/export.hpp"

namespace sepcal::exporting {

/// A line each: what made the file of which calibration, its flight, and the fit.
std::vector<std::string> provenance(const std::string& what, const Calibration& given,
                                    const Calibration& held);

/// What a vehicle's user must know, a line each; `approximation` too.
std::vector<std::string> approximation_lines(const Approximation& approximation);

/// Of a magnetometer that the calibration turns: what was done with that, and what the other way
/// would lose. Empty of any other.
std::vector<std::string> rotation_lines(const Exported& exported);

}  // namespace sepcal::exporting
