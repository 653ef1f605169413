// SPDX-License-Identifier: BSD-3-Clause
// Causes that come and go and follow no channel of the log: what moves several outputs together,
// and what swings at one frequency.
#pragma once

#include <cstdint>
#include <vector>

#include "diagnosis/candidate.hpp"
#include "diagnosis/input_noise.hpp"
#include "diagnosis/null_hypothesis.hpp"
#include "sepcal/diagnosis.hpp"

namespace sepcal::diagnosis {

/// One of each kind that the record can show, each with its own probability, significant or not.
/// Noise of the inputs, which comes into several outputs at once, is no common cause.
std::vector<UnmeasuredCause> find_unmeasured(const CandidateRoom& room, const NullHypothesis& null,
                                             const InputNoise* inputs, std::uint64_t seed);

/// Corrects their probabilities and that of the offsets for their number (Holm), and keeps the
/// causes that are significant, the surest first.
void correct_together(double significance, Omnibus& offsets, std::vector<UnmeasuredCause>& causes);

}  // namespace sepcal::diagnosis
