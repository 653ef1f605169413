// SPDX-License-Identifier: BSD-3-Clause
// What a trial says of its effect, in the words of the result.
#pragma once

#include "diagnosis/trial.hpp"
#include "sepcal/diagnosis.hpp"

namespace sepcal::diagnosis {

/// All but what depends on the other trials: the adjusted probabilities, `found`, what it is beside
/// the first.
EffectFinding describe(const CandidateRoom& room, const Trial& trial);

/// What rows held out say of it.
void tell_held_out(const Trial& trial, EffectFinding& finding);

/// The share of the error on rows held out that is left; all of it where they were not asked.
double left_out(const EffectFinding& finding);

/// At the shape where a screened trial explains most.
Structure structure_of(const NullHypothesis& null, const Trial& trial, PseBound bound);

}  // namespace sepcal::diagnosis
