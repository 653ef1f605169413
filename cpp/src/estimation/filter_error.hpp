// SPDX-License-Identifier: BSD-3-Clause
// Filter error: parameters, process noise and noise of the outputs together, by the likelihood of a
// filter's innovations (system identification summary, S 5.1 to 5.9).
#pragma once

#include "sepcal/block_model.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal::estimation {

/// Outputs may be missing, NaN. Throws Error where the model has no state that noise drives, for
/// what filter error does without (a loss), and as fit() does.
Fit fit_filter_error(const BlockModel& model, const Record& record, const FitOptions& options);

}  // namespace sepcal::estimation
