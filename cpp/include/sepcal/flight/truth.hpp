// SPDX-License-Identifier: BSD-3-Clause
// The truth behind a simulated flight, as JSON: {"model", "parameters" {name: value}, "options"
// {k_alpha, k_beta, lever_arm | field}, "noise" {output: standard deviation}}. What a file leaves
// out keeps its default, so that a file may name just what it changes.
#pragma once

#include <string>
#include <string_view>

#include "sepcal/flight/simulate.hpp"

namespace sepcal {

std::string to_json(const FiveHoleTruth& truth);
std::string to_json(const MagnetometerTruth& truth);

/// Throws Error, opened by `source`, for text that is no JSON object of this kind, a name that the
/// model doesn't have, or a value that is no number.
FiveHoleTruth parse_five_hole_truth(std::string_view json, const std::string& source);
MagnetometerTruth parse_magnetometer_truth(std::string_view json, const std::string& source);

}  // namespace sepcal
