// SPDX-License-Identifier: BSD-3-Clause
// Filter error: parameters, process noise and noise of the outputs together, by the likelihood of a
// filter's innovations (system identification summary, S 5.1 to 5.9).
#pragma once

#include <memory>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal::estimation {

/// The likelihood. Throws Error where there is none: of a loss, or of a model without a state or
/// without process noise. The model and the record must outlive it.
std::unique_ptr<InnovationModel> innovations_of(const BlockModel& model, const Record& record,
                                                const FitOptions& options);

/// Outputs may be missing, NaN. Throws Error where the model has no state that noise drives, for
/// what filter error does without (a loss), and as fit() does.
Fit fit_filter_error(const BlockModel& model, const Record& record, const FitOptions& options);

}  // namespace sepcal::estimation
