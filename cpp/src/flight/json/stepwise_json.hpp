// SPDX-License-Identifier: BSD-3-Clause
// The steps of a stepwise diagnosis as JSON.
#pragma once

#include "flight/json/output_values.hpp"
#include "sepcal/flight/stepwise.hpp"

namespace sepcal::json {

/// {steps [{effect, ...}], end, reason, verdict}
Json write_stepwise(const Stepwise& course);

}  // namespace sepcal::json
