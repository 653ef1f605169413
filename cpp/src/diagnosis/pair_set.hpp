// SPDX-License-Identifier: BSD-3-Clause
// Two causes at once: a channel that goes with both may pass for them, and a flight seldom says
// which two they are. What it does say is the set of pairs that explain it as well as anything.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/candidate_testing.hpp"

namespace sepcal::diagnosis {

/// Pairs of the surest trials, "wind[time]+bias_step", best first and a dozen at most: those whose
/// Schwarz criterion is within 9.2 of the least that a single trial or a pair has in this noise,
/// and below those of its members; by one step from the fit. `of_lines`: of the best of either
/// screen that are lines along a channel or have no driver.
std::vector<std::string> find_pair_set(const CandidateTesting& testing, const Trials& trials,
                                       const NoiseMembers& noise, bool of_lines = false);

}  // namespace sepcal::diagnosis
