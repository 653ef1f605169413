// SPDX-License-Identifier: BSD-3-Clause
// Where a model fails, beside by maneuver: against which channel, and when.
#pragma once

#include "base/page.hpp"
#include "sepcal/flight/comparison.hpp"

namespace sepcal::text {

/// The three channels that explain most of each output's residual, or a line saying that none does.
base::Page channel_table(const Comparison& comparison);

/// The worst windows, each with the error and the mean of every output.
base::Page window_table(const Comparison& comparison);

}  // namespace sepcal::text
