// SPDX-License-Identifier: BSD-3-Clause
// The effects on air-data probes: where the world or the instrument departs from the model.
#pragma once

#include "sepcal/named_effects.hpp"

namespace sepcal::catalogue {

EffectKit five_hole_effects();
EffectKit pitot_static_effects();

}  // namespace sepcal::catalogue
