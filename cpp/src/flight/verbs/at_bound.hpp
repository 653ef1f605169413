// SPDX-License-Identifier: BSD-3-Clause
// Which parameters a bound stopped: later verbs repeat it beside the status of the fit.
#pragma once

#include <string>
#include <vector>

#include "sepcal/fit.hpp"

namespace sepcal::verbs {

inline std::vector<std::string> names_at_bound(const Fit& fit) {
  std::vector<std::string> names;
  for (const Parameter& parameter : fit.parameters) {
    if (parameter.at_bound) names.push_back(parameter.name);
  }
  return names;
}

}  // namespace sepcal::verbs
