// SPDX-License-Identifier: BSD-3-Clause
// A fit as the middle of a page: status, parameters, errors, what the stages did.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/calibration.hpp"

namespace sepcal::text {

std::string fit_table(const Fit& fit, const CalibrationOptions& options,
                      const std::vector<Derived>& derived, Detail detail);

}  // namespace sepcal::text
