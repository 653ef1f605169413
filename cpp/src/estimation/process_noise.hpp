// SPDX-License-Identifier: BSD-3-Clause
// Standard errors of a model with a state that is integrated without the process noise that drives
// it: the sandwich's middle has then the noise's share too (BlockModel::score_noise()).
#pragma once

#include "sepcal/detail/block_model.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal::estimation {

/// Throws Error for process noise that the model doesn't have.
void check_process_noise(const BlockModel& model, const FitOptions& options);

/// Widens covariance and standard errors of a fit to this record by FitOptions::process_noise, and
/// says by how much. What the residuals' colour tells of the noise already is not counted twice:
/// the larger of both counts.
void allow_for_process_noise(Fit& result, const BlockModel& model, const Record& record,
                             const FitOptions& options);

}  // namespace sepcal::estimation
