// SPDX-License-Identifier: BSD-3-Clause
// Advice is given only for what a real fit bears out: one step from the fit may promise what no fit
// keeps.
#pragma once

#include <string>

#include "diagnosis/candidate.hpp"

namespace sepcal::diagnosis {

/// Why the effect that was found should not be added, as the end of a sentence; empty where a fit
/// with it converges within its bounds, agrees with the step and predicts rows left out better.
std::string reason_against(CandidateRoom& room, const EffectFinding& finding,
                           double least_visibility, base::ThreadPool& pool);

}  // namespace sepcal::diagnosis
