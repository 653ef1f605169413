// SPDX-License-Identifier: BSD-3-Clause
// A calibration and the record of a flight, as the engine's diagnosis takes them.
#pragma once

#include "sepcal/diagnosis.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal::verbs {

/// `record`: what Probe::prepare() gave, before effects in time cut its edges. `own`: effects that
/// the calibration or the caller made.
DiagnosedFit diagnosed_fit(const Calibration& calibration, const Record& record,
                           const OwnEffects& own);

}  // namespace sepcal::verbs
