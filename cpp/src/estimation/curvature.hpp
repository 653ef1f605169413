// SPDX-License-Identifier: BSD-3-Clause
// Whether standard errors can hold: they take the cost for a parabola, which on a short turn, or
// along a valley that bends, it is not within one of them.
#pragma once

#include <string>

#include "estimation/stage_two.hpp"
#include "model/sweep.hpp"

namespace sepcal::estimation {

/// A sentence where the cost three standard errors from the estimate, either way along what is
/// known least (in plausible lengths), rises by less than half or more than twice what the parabola
/// does. Empty where it doesn't, with a loss, where a bound is in the way, and where there is no
/// noise to speak of. Three passes.
std::string describe_curvature(const Problem& problem, const model::Sweep& sweep,
                               const StageTwo& two);

}  // namespace sepcal::estimation
