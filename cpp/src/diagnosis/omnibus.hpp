// SPDX-License-Identifier: BSD-3-Clause
// What is left once no candidate passes: is anything there at all, and how small a slow effect
// would have been seen?
#pragma once

#include <vector>

#include "diagnosis/candidate.hpp"
#include "diagnosis/null_hypothesis.hpp"
#include "sepcal/diagnosis.hpp"

namespace sepcal::diagnosis {

/// Offsets of each output and of each port by maneuver, or by windows of at least ten correlation
/// times; the smallest probability of these sets, corrected for their number and calibrated by
/// simulation.
Omnibus test_for_structure(CandidateRoom& room, const EffectKit& kit, const NullHypothesis& null,
                           const DiagnosisOptions& options, base::ThreadPool& pool);

/// The smallest straight line in time on every port that would be found nine times in ten among
/// `candidates` of them.
std::vector<DetectionLimit> find_limits(CandidateRoom& room, const EffectKit& kit,
                                        const NullHypothesis& null, double significance,
                                        std::size_t candidates);

}  // namespace sepcal::diagnosis
