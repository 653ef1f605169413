// SPDX-License-Identifier: BSD-3-Clause
// Model + effects is again a model, put together at run time. Inputs merge by name; delays act on
// the inputs first, then corrections, each on what those before it left; the model and every term
// see the corrected inputs, drivers the logged ones. The order in which effects are named is the
// order of the parameters, and matters otherwise only to corrections of the same inputs.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/effect.hpp"
#include "sepcal/detail/tables.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// The model with `effects`. `record` is read now, and only by delays; it must be the one that is
/// fitted (or compared with), before without_edges(). Throws Error naming both owners for a
/// parameter name used twice and for inputs of one name and two units, and naming the effect for a
/// target or an input that the model doesn't have and a term with another number of outputs.
std::shared_ptr<const BlockModel> compose(std::shared_ptr<const BlockModel> model,
                                          const std::vector<Effect>& effects, const Record& record);

/// The nonlinear coefficients of effects that correct something, all zero: where a fit with effects
/// begins (FitOptions::unsampled). Shapes (exponents, delays of a driver) are not among them.
std::map<std::string, double> initial_corrections(const std::vector<Effect>& effects);

/// How near a row may lie to a segment's edge [s] without a delay reaching across it: its longest
/// shift within its bounds. `bounds` replace a parameter's own. 0 where nothing is shifted. Throws
/// Error for bounds that aren't finite.
double reach(const std::vector<Effect>& effects,
             const std::map<std::string, Interval>& bounds = {});

/// The record without the rows nearer than `margin` [s] to an edge of their segment; segments that
/// are shorter vanish. Throws Error where nothing is left.
Record without_edges(Record record, double margin);

}  // namespace sepcal
