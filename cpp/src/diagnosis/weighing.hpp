// SPDX-License-Identifier: BSD-3-Clause
// Where nothing is found: which effects are fitted for what they may take of the error, and which
// of those that do take much stands first.
#pragma once

#include <vector>

#include "diagnosis/candidate_testing.hpp"

namespace sepcal::diagnosis {

/// What is not found and may take much of the error, as one step has it: those that take most, and
/// the surest of those that are no functions of any form.
std::vector<EffectFinding*> choose_to_weigh(CandidateTesting& testing,
                                            std::vector<EffectFinding>& findings);

/// Puts slow changes before what is undecided, and this before the rest. Of the slow changes, or
/// else of what is undecided, the simplest of those that leave about as little of the error stands
/// first, the others of these next, as equivalent. With them go the lines that are surest in noise
/// as instruments have it, for curves follow noise that wanders; where a line is among both, those
/// alone that are. Functions of time of any form stand first where they leave clearly less.
void put_simplest_first(CandidateTesting& testing, std::vector<EffectFinding>& findings);

}  // namespace sepcal::diagnosis
