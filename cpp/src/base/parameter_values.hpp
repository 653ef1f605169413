// SPDX-License-Identifier: BSD-3-Clause
// Values by name, and in the order of a table.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "sepcal/detail/tables.hpp"

namespace sepcal::base {

using ParameterValues = std::map<std::string, double>;

/// Throws Error for a name without a value.
double value_of(const ParameterValues& values, const std::string& name);

/// The values in the order of `parameters`. Throws Error for one without a value.
Eigen::VectorXd in_order(const std::vector<Variable>& parameters, const ParameterValues& values);

/// Standard deviations in the order of a table; 0 for those not named. Throws Error for names that
/// the table, of `what`, doesn't have and for what is no standard deviation.
Eigen::VectorXd deviations_in_order(const std::vector<Variable>& table,
                                    const std::map<std::string, double>& deviations,
                                    const std::string& what);

}  // namespace sepcal::base
