// SPDX-License-Identifier: BSD-3-Clause
// Scales that no sensor has: what a wrong unit, a sign or a wrong minimum makes of a fit that
// converges.
#pragma once

#include <span>
#include <string_view>

#include "sepcal/fit.hpp"

namespace sepcal::probes {

/// A parameter that is a scale or the error of one.
struct Scale {
  std::string_view parameter;
  double nominal;  // 1 or 0: its value where the sensor reads right
};

/// A scale that only its bound holds at least_scale, or one below, makes the fit not identifiable.
/// One that is more than 0.2 off is worth a sentence. Those that are fixed are not judged.
void judge_scales(Fit& fit, std::span<const Scale> scales);

}  // namespace sepcal::probes
