// SPDX-License-Identifier: BSD-3-Clause
// Cross-validation by real fits: what one step from the fit can't judge, as effects that bend the
// model or leave it poorly determined.
#pragma once

#include "diagnosis/candidate.hpp"
#include "diagnosis/held_out.hpp"

namespace sepcal::diagnosis {

/// Rows that a fit of a long record needs, where one step or a prediction follows.
inline constexpr std::size_t enough_rows = 20000;

/// Where a scanned effect was found; NaN for others.
double shape_of(const EffectFinding& finding);

/// The fit of the model with the candidate to all rows, from the estimates without it and from the
/// shape, which a step keeps.
Fit refit_with(const CandidateRoom& room, const Candidate& candidate, double shape);

/// The same to about `most_rows` where there are more, in blocks that lie evenly over every
/// segment: one step from the fit to all rows, as linearised there. `coloured_errors`: as of
/// FitOptions; without them standard errors are those of white noise.
Fit refit_nearly(const CandidateRoom& room, const Candidate& candidate, double shape,
                 std::size_t most_rows, bool coloured_errors = false);

/// By how much the error over all outputs, each in units of its own, falls from one fit to another,
/// 1 - after / before: as adding an effect reports it along a path.
double error_drop(const Fit& before, const Fit& after);

/// What that is of adding the candidate to a model with a state, of which `fitted` is
/// refit_with()'s: by filter error noises are free again, as adding leaves them. NaN where that
/// can't be fitted.
double drop_of_adding(const CandidateRoom& room, const Candidate& candidate, const Fit& fitted);

/// Fits the model with and without the candidate to all folds but one, from the estimates on all
/// rows and within the fit's bounds, and predicts the rows left out; of long records to some of the
/// rows, spread evenly. Not judged where a fit fails.
HeldOut hold_out_by_refits(const CandidateRoom& room, const Candidate& candidate, double shape,
                           const Folds& folds, base::ThreadPool& pool);

}  // namespace sepcal::diagnosis
