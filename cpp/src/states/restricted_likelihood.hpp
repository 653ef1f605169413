// SPDX-License-Identifier: BSD-3-Clause
// Process noises of few rows, by the restricted likelihood (Patterson & Thompson, Biometrika 58,
// 1971; Harville, JASA 72, 1977): ln L where the parameters are best, and half of ln det of their
// covariance. In few rows the parameters follow part of the noise; the likelihood alone then finds
// too little noise, or none, and parameters that are surer than they may be.
#pragma once

#include "sepcal/detail/block_model.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal::states {

/// Whether the rows tell the size of each process noise that a fit by filter error estimated: to a
/// quarter of it, and above its floor.
bool tells_process_noises(const Fit& fit);

/// `fit` again, of the same rows by the same options, with each process noise that was estimated
/// held where the restricted likelihood is greatest, to a seventh of its size.
Fit fit_restricted(const BlockModel& model, const Record& record, FitOptions options,
                   const Fit& fit);

}  // namespace sepcal::states
