// SPDX-License-Identifier: BSD-3-Clause
// Parameters' values by name, and in the order of a table.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "sepcal/quantity.hpp"

namespace sepcal::base {

using ParameterValues = std::map<std::string, double>;

/// Throws Error for a name without a value.
double value_of(const ParameterValues& values, const std::string& name);

/// The values in the order of `parameters`. Throws Error for one without a value.
Eigen::VectorXd in_order(const std::vector<Variable>& parameters, const ParameterValues& values);

}  // namespace sepcal::base
