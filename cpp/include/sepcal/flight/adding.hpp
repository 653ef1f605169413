// SPDX-License-Identifier: BSD-3-Clause
// The step from one calibration to the next: an effect is added, everything is fitted again from
// where the last fit ended, and the error before and after goes into the history.
#pragma once

#include <string>

#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/comparison.hpp"

namespace sepcal {

/// `base` with `effect` (a name, an alias, or several joined by '+'), refitted to `flight` from the
/// base's estimates. Its history is the base's and one entry more, in which both errors are of the
/// rows that the new fit used. `own` joins the base's own effects. Throws Error for bad input and
/// for an effect that the base has already.
Calibration add(const Calibration& base, const Flight& flight, const std::string& effect,
                const OwnEffects& own = {}, const FitProgress& progress = {});

/// Where the model would fail with `effect` added, for a look: no history, nothing promised. Throws
/// Error as add() does.
Comparison compare_with(const Calibration& base, const Flight& flight, const std::string& effect);

}  // namespace sepcal
