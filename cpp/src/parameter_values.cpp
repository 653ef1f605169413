// SPDX-License-Identifier: BSD-3-Clause
#include "parameter_values.hpp"

#include "sepcal/error.hpp"

namespace sepcal {

using Eigen::Index;
using Eigen::VectorXd;

ParameterValues values_by_name(const Fit& fit) {
  ParameterValues values;
  for (const Parameter& parameter : fit.parameters) values[parameter.name] = parameter.value;
  return values;
}

ParameterValues nonlinear_estimates(const Fit& fit) {
  ParameterValues values;
  for (auto k = static_cast<std::size_t>(fit.n_1); k < fit.parameters.size(); ++k) {
    if (!fit.parameters[k].fixed) values[fit.parameters[k].name] = fit.parameters[k].value;
  }
  return values;
}

double value_of(const ParameterValues& values, const std::string& name) {
  const auto at = values.find(name);
  if (at != values.end()) return at->second;
  throw Error("there is no value of the parameter '" + name + "'; fit the flight again");
}

VectorXd in_order(const std::vector<Variable>& parameters, const ParameterValues& values) {
  VectorXd ordered(static_cast<Index>(parameters.size()));
  for (Index k = 0; k < ordered.size(); ++k) {
    ordered[k] = value_of(values, parameters[static_cast<std::size_t>(k)].name);
  }
  return ordered;
}

}  // namespace sepcal
