// SPDX-License-Identifier: BSD-3-Clause
// The colour of a residual: which noise model it has, if it is not white.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sepcal/noise_model.hpp"

namespace sepcal {

/// The noise of an output's residual `e`, or nothing where there is none to tell: fewer than 30
/// rows, or a residual of zeros. White where nothing else is better by BIC.
std::optional<NoiseModel> find_residual_noise(std::span<const double> e,
                                              const std::vector<Segment>& segments);

}  // namespace sepcal
