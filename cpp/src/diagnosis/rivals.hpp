// SPDX-License-Identifier: BSD-3-Clause
// What would do as well instead may say otherwise what the model's own parameters are: then one
// record can't tell which to believe, and adding the wrong one takes them from the truth.
#pragma once

#include <string>

#include "diagnosis/alternatives.hpp"

namespace sepcal::diagnosis {

/// Why an effect should not be added before one that would do as well is ruled out: the end of a
/// sentence, empty where none of `findings` would take a parameter elsewhere.
std::string find_rival(CandidateTesting& testing, ModelSelection& selection,
                       const EffectFinding& advised, const std::vector<EffectFinding>& findings);

}  // namespace sepcal::diagnosis
