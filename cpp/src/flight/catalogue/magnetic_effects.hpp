// SPDX-License-Identifier: BSD-3-Clause
// The effects on magnetometers.
#pragma once

#include "sepcal/named_effects.hpp"

namespace sepcal::catalogue {

EffectKit magnetometer_effects();

/// Only those that show in the strength of the field.
EffectKit attitude_independent_effects();

}  // namespace sepcal::catalogue
