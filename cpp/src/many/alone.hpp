// SPDX-License-Identifier: BSD-3-Clause
// A joint fit's options for each flight alone, where the joint one begins.
#pragma once

#include "sepcal/options.hpp"

namespace sepcal::many {

inline FitOptions alone(FitOptions options) {
  options.coloured_errors = false;  // nobody asks for them
  options.progress = {};
  return options;
}

}  // namespace sepcal::many
