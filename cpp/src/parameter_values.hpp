// SPDX-License-Identifier: BSD-3-Clause
// Parameters' values by name, in and out of a fit.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "sepcal/fit.hpp"

namespace sepcal {

using ParameterValues = std::map<std::string, double>;

/// Every parameter of the fit.
ParameterValues values_by_name(const Fit& fit);

/// The nonlinear ones that were estimated: where another fit begins (FitOptions::start).
ParameterValues nonlinear_estimates(const Fit& fit);

/// Throws Error for a name without a value.
double value_of(const ParameterValues& values, const std::string& name);

/// The values in the order of `parameters`. Throws Error for one without a value.
Eigen::VectorXd in_order(const std::vector<Variable>& parameters, const ParameterValues& values);

}  // namespace sepcal
