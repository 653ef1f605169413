// SPDX-License-Identifier: BSD-3-Clause
// Effects that bend the model: one step from a fit that is far off may see little in what explains
// everything once it is fitted.
#pragma once

#include <vector>

#include "diagnosis/contenders.hpp"

namespace sepcal::diagnosis {

/// Where the residuals are several times what noise leaves, every visible candidate that is not in
/// the contest is fitted. One that is likelier than all that were found joins them, as sure as the
/// surest, with the estimates of its fit, if real fits without some rows predict these better.
void admit_bent(Bench& bench, Contest& contest, std::vector<EffectFinding>& findings);

}  // namespace sepcal::diagnosis
