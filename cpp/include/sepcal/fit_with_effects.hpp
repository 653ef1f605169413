// SPDX-License-Identifier: BSD-3-Clause
// A fit of any model, compiled or not, with effects that join it by name.
#pragma once

#include <memory>
#include <vector>

#include "sepcal/detail/named_effects.hpp"
#include "sepcal/fit.hpp"

namespace sepcal {

/// Fits `model` with the effects that `settings` name, made by `kit`: plain_kit() for the model's
/// own linear parameters and inputs. What the settings lack is taken from `record` and stays in
/// them, the times of steps as the fit finds them. The effects' corrections begin at zero. Rows at
/// a segment's edge are left out where inputs are late, but of a model that integrates a state.
/// Throws Error as make_effects(), compose(), without_edges() and fit() do.
Fit fit_with_effects(const std::shared_ptr<const BlockModel>& model, const EffectKit& kit,
                     std::vector<EffectSetting>& settings, Record record,
                     const FitOptions& options = {});

}  // namespace sepcal
