// SPDX-License-Identifier: BSD-3-Clause
#include "base/parameter_values.hpp"

#include <algorithm>
#include <cmath>

#include "base/name_list.hpp"
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

VectorXd deviations_in_order(const std::vector<Variable>& table,
                             const std::map<std::string, double>& deviations,
                             const std::string& what) {
  VectorXd result = VectorXd::Zero(static_cast<Index>(table.size()));
  for (const auto& [name, deviation] : deviations) {
    const auto at = std::ranges::find(table, name, &Variable::name);
    if (at == table.end()) {
      throw Error("the model has no " + what + " '" + name + "'; it has " + list_names(table));
    }
    if (!(deviation >= 0.0) || !std::isfinite(deviation)) {
      throw Error(what + " '" + name + "' needs a standard deviation of 0 or more");
    }
    result[at - table.begin()] = deviation;
  }
  return result;
}

}  // namespace sepcal::base
