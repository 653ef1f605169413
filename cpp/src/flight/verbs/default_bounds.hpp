// SPDX-License-Identifier: BSD-3-Clause
// A default bound is no knowledge: where a parameter ends at one the fit is tried beyond it.
#pragma once

#include <map>
#include <string>

#include "sepcal/fit.hpp"

namespace sepcal::verbs {

using Bounds = std::map<std::string, Interval>;

/// Bounds to try of the parameters that ended at one that is not among `given`: two widths farther
/// on that side, a scale above what a sensor has. Of an open interval there are none.
Bounds find_bounds_beyond(const Fit& fit, const Bounds& given);

/// Whether a fit within wider bounds is to be believed instead: lower, by the data alone, and with
/// each of the bounds refuted by two standard errors.
bool is_regular_beyond(const Bounds& tried, const Fit& at_bounds, const Fit& beyond);

/// Whether the scale errors lambda are small on average. Where they aren't, a unit or the field's
/// strength is wrong, and a fit beyond the bounds is no answer.
bool has_plausible_scales(const Fit& fit);

/// "lambda_z ended at its default bound of 0.5, ..."; the values are those beyond. `adopted`: the
/// fit that says so is the one beyond.
std::string describe_beyond(const Bounds& tried, const Fit& at_bounds, const Fit& beyond,
                            bool adopted);

}  // namespace sepcal::verbs
