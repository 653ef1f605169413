// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sepcal/detail/block_model.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/record.hpp"

namespace sepcal::estimation {

/// Of a fit where something is amiss already: says first where a state runs away along a
/// trajectory, so that the end is rounding's choice, and claims no convergence then.
void warn_of_runaway(Fit& result, const BlockModel& model, const Record& record);

/// Says first where steps of integration are long beside the fastest rate of the dynamics at the
/// fit, and claims no convergence where the answer is the integration's, not the dynamics'.
void warn_of_coarse_steps(Fit& result, const BlockModel& model, const Record& record);

}  // namespace sepcal::estimation
