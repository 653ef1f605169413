// SPDX-License-Identifier: BSD-3-Clause
// The effects that a model of the user's own may lack, as its tables tell them.
#pragma once

#include "flight/catalogue/effect_table.hpp"
#include "sepcal/flight/own_model.hpp"

namespace sepcal::subjects {

/// Ports for every linear parameter, input and output, constants of the outputs, and delays. Of a
/// model with a state no linear parameter of its dynamics is a port, and only inputs are late.
catalogue::EffectTable own_effects(const LaidModel& laid);

}  // namespace sepcal::subjects
