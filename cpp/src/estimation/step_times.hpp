// SPDX-License-Identifier: BSD-3-Clause
// When something was switched on: the times of steps, found by a scan and then held, for the cost
// has no slope in them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sepcal/detail/named_effects.hpp"
#include "sepcal/fit.hpp"

namespace sepcal::estimation {

/// The parameters that are steps' times, and whose time they are.
std::map<std::string, EffectSetting*> step_times(std::vector<EffectSetting>& settings,
                                                 const std::vector<Effect>& effects);

/// Fits `model` with the steps at the times that explain most: a scan at the estimates without
/// them, a fit, a scan at its estimates, and so on until no time moves. Times that are held in
/// `options` stay. The settings get the times found. `model`: with all effects; `effects`: all of
/// them; `plain`: the model without effects.
Fit fit_with_steps(const BlockModel& model, const BlockModel& plain,
                   const std::vector<Effect>& effects, std::vector<EffectSetting>& settings,
                   const Record& record, FitOptions options);

}  // namespace sepcal::estimation
