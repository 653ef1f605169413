// SPDX-License-Identifier: BSD-3-Clause
// The positive control: without a mistake it compiles, with the same compiler and options.
#include "pitot_tube.hpp"

namespace sepcal {

static_assert(SeparableModel<PitotTube>);

}  // namespace sepcal
