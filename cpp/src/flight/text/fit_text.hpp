// SPDX-License-Identifier: BSD-3-Clause
// A fit as the middle of a page: status, parameters, errors, what the stages did.
#pragma once

#include <vector>

#include "base/page.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal::text {

base::Page fit_table(const Fit& fit, const CalibrationOptions& options,
                     const std::vector<Derived>& derived, Detail detail);

/// Pairs of estimates that go together; explained, the directions that are hardly determined too.
base::Page collinearity_lines(const Fit& fit, Detail detail);

}  // namespace sepcal::text
