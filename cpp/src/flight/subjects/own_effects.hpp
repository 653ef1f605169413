// SPDX-License-Identifier: BSD-3-Clause
// The effects that a model of the user's own may lack, as its tables tell them.
#pragma once

#include "flight/catalogue/effect_table.hpp"
#include "sepcal/tables.hpp"

namespace sepcal::subjects {

/// Ports for every linear parameter, input and output, constants of the outputs, and delays.
catalogue::EffectTable own_effects(const Tables& tables);

}  // namespace sepcal::subjects
