// SPDX-License-Identifier: BSD-3-Clause
// How the tables of a model and its effects are joined: inputs merge by name, parameters may not.
#pragma once

#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/effect.hpp"

namespace sepcal::effects {

/// The model's tables, then each effect's in turn: of its varying parameters (coefficients; shape),
/// its terms, its corrections and its delays. Throws Error naming both owners for a parameter name
/// used twice, for one input in two units, and for a term with other outputs than the model has.
Tables join_tables(const BlockModel& model, const std::vector<Effect>& effects);

/// Index of an input in `tables`, which has it.
int input_index(const Tables& tables, const std::string& name);

/// The age, in units of the lag, up to which the average over the past that a lag of the outputs is
/// must lie within a segment; what is older weighs 1e-4.
inline constexpr double oldest_age = 7.0459054023934655;

}  // namespace sepcal::effects
