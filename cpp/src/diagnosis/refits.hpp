// SPDX-License-Identifier: BSD-3-Clause
// Cross-validation by real fits: what one step from the fit can't judge, as effects that bend the
// model or leave it poorly determined.
#pragma once

#include "diagnosis/candidate.hpp"
#include "diagnosis/held_out.hpp"

namespace sepcal::diagnosis {

/// Where a scanned effect was found; NaN for others.
double shape_of(const EffectFinding& finding);

/// The fit of the model with the candidate to all rows, from the estimates without it.
Fit refit_with(const CandidateRoom& room, const Candidate& candidate, double shape);

/// Fits the model with and without the candidate to all folds but one, from the estimates on all
/// rows and within the fit's bounds, and predicts the rows left out. Not judged where a fit fails.
HeldOut hold_out_by_refits(const CandidateRoom& room, const Candidate& candidate, double shape,
                           const Folds& folds, base::ThreadPool& pool);

}  // namespace sepcal::diagnosis
