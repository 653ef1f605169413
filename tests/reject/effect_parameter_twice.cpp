// SPDX-License-Identifier: BSD-3-Clause
// The same effect twice.
// expect: a parameter's name belongs to the model and to the effect alike; rename one
// expect: sepcal::WindDrift
#include "windy_tube.hpp"

namespace sepcal {

static_assert(SeparableModel<decltype(PitotTube{} + WindDrift{} + WindDrift{})>);

}  // namespace sepcal
