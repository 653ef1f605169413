// SPDX-License-Identifier: BSD-3-Clause
// Effects that bend the model: one step from a fit that is far off may see little in what explains
// everything once it is fitted.
#pragma once

#include <vector>

#include "diagnosis/alternatives.hpp"

namespace sepcal::diagnosis {

/// Whether the RMSE is several times what noise leaves.
bool is_far_off(const CandidateTesting& testing, double floor);

/// The few that are the best by fits to some rows, of those that can be seen, are no functions of
/// any form and are not known already.
std::vector<Alternative> try_on_some_rows(CandidateTesting& testing,
                                          const std::vector<EffectFinding>& findings,
                                          const std::vector<Alternative>& known);

/// Far off, the best of those that are not in the selection are fitted. One that is likelier than
/// all that were found joins them, as sure as the surest, with the estimates of its fit, if this
/// takes a fifth of the error and real fits without some rows predict these better.
void admit_nonlinear(CandidateTesting& testing, ModelSelection& selection,
                     std::vector<EffectFinding>& findings);

}  // namespace sepcal::diagnosis
