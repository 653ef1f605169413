// SPDX-License-Identifier: BSD-3-Clause
// Advice is given only for what a real fit bears out: one step from the fit may promise what no fit
// keeps.
#pragma once

#include <string>

#include "diagnosis/candidate.hpp"
#include "diagnosis/refits.hpp"

namespace sepcal::diagnosis {

/// Why an effect that was found should not be added.
struct Objection {
  std::string reason = {};  // as the end of a sentence; empty where there is none
  /// Whether no fit takes the effect as it was found, large as it may be: what counts beside it
  /// would then stand in for it.
  bool is_to_fit = false;
  bool is_of_bounds = false;  // a fit takes the effect as far as its bounds let it
  bool is_of_rival = false;   // the effect stands, but another could be the cause as well
  /// What a fit with the effect takes from the error, drop_of_adding(); NaN where none was made,
  /// and of models without a state.
  double drop = not_a_number;
};

/// None where a fit with the effect converges within its bounds, agrees with the step, or takes as
/// much of the error, of rows left out a fifth at least, and predicts rows left out better.
Objection find_objection(CandidateRoom& room, Refits& refits, const EffectFinding& finding,
                         double least_visibility);

}  // namespace sepcal::diagnosis
