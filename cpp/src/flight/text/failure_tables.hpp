// SPDX-License-Identifier: BSD-3-Clause
// Where a model fails, beside by maneuver: against which channel, when, and against references; and
// how well it follows as a whole.
#pragma once

#include "base/page.hpp"
#include "sepcal/flight/comparison.hpp"

namespace sepcal::text {

/// The three channels that explain most of each output's residual, or a line saying that none does.
base::Page channel_table(const Comparison& comparison);

/// The worst windows, each with the error and the mean of every output.
base::Page window_table(const Comparison& comparison);

/// R^2 and Theil's coefficient of every output.
base::Page validation_table(const Comparison& comparison);

/// What is calibrated against references; empty where none were asked for.
base::Page reference_table(const Comparison& comparison);

}  // namespace sepcal::text
