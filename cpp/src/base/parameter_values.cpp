// SPDX-License-Identifier: BSD-3-Clause
#include "base/parameter_values.hpp"

#include "sepcal/error.hpp"

namespace sepcal::base {

using Eigen::Index;
using Eigen::VectorXd;

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

}  // namespace sepcal::base
