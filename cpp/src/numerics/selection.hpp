// SPDX-License-Identifier: BSD-3-Clause
// What is left of an estimate when it is told only because it was large.
#pragma once

namespace sepcal::numerics {

/// The share of an estimate to believe that is `size` standard errors from zero and would not have
/// been told within `least` of them: half way between it and the mean of its likelihood given that
/// it was told (Zhong & Prentice, Biostatistics 9 (2008), Sec. 2). 1 where `size` is so large that
/// the choice says nothing; within [0, 1].
double share_after_selection(double size, double least);

}  // namespace sepcal::numerics
