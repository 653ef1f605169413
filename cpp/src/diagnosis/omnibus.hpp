// SPDX-License-Identifier: BSD-3-Clause
// What is left once no candidate passes: is anything there at all, and how small a slow effect
// would have been seen?
#pragma once

#include <vector>

#include "diagnosis/candidate.hpp"
#include "diagnosis/input_noise.hpp"
#include "diagnosis/instrument_noise.hpp"
#include "diagnosis/null_hypothesis.hpp"
#include "sepcal/diagnosis.hpp"

namespace sepcal::diagnosis {

/// Offsets of each output and of each port by maneuver, or by windows of at least ten correlation
/// times; the smallest probability of these sets, corrected for their number: in noise as
/// instruments have it, where the log's is such (`instruments`), else calibrated by simulation.
Omnibus test_for_structure(CandidateRoom& room, const EffectKit& kit, const NullHypothesis& null,
                           const InstrumentNoise* instruments, const InputNoise* inputs,
                           const DiagnosisOptions& options, base::ThreadPool& pool);

/// The smallest straight line in time on every port that would be found nine times in ten among
/// `candidates` of them: in noise as instruments have it, where that is known (`instruments`).
/// Infinite where it would move the outputs by more than all that they do.
std::vector<DetectionLimit> find_limits(CandidateRoom& room, const EffectKit& kit,
                                        const NullHypothesis& null,
                                        const InstrumentNoise* instruments, double significance,
                                        std::size_t candidates);

}  // namespace sepcal::diagnosis
