// SPDX-License-Identifier: BSD-3-Clause
// Two sensors side by side whose parameters have the same names; with labels they compile.
// expect: a parameter or an output of one name belongs to both sensors: say Labelled
// expect: sepcal::PitotTube
#include "pitot_tube.hpp"
#include "sepcal/detail/static_concatenation.hpp"

namespace sepcal {

static_assert(SeparableModel<decltype(concatenate(Labelled<"left", PitotTube>{},
                                                  Labelled<"right", PitotTube>{}))>);
static_assert(SeparableModel<decltype(concatenate(PitotTube{}, PitotTube{}))>);

}  // namespace sepcal
