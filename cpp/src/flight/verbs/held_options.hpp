// SPDX-License-Identifier: BSD-3-Clause
// What a probe holds at a value unless the caller frees it.
#pragma once

#include <map>
#include <string>

#include "sepcal/flight/calibration.hpp"

namespace sepcal::verbs {

/// The options with what the probe holds unless it is freed among the fixed. Throws Error for a
/// freed parameter that there isn't or that is fixed, and for bounds of a parameter that is held.
CalibrationOptions hold(const Probe& probe, CalibrationOptions options);

/// The same of a model without a probe, of whose `held` those count that it has.
CalibrationOptions hold(const std::map<std::string, double>& held, const Tables& tables,
                        CalibrationOptions options);

}  // namespace sepcal::verbs
