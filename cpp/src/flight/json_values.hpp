// SPDX-License-Identifier: BSD-3-Clause
// Numbers and names to and from JSON: undefined and infinite numbers are null, keys keep their
// order.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sepcal/fit.hpp"

namespace sepcal {

using Json = nlohmann::ordered_json;

/// null for NaN and infinities.
Json number(double value);

/// The number, or `missing` for null. Throws Json::exception for anything else.
double number_or(const Json& value, double missing);

/// {"vn": 0.15, ...}
Json by_name(const std::vector<OutputValue>& values);
std::vector<OutputValue> values_by_name(const Json& object);

/// [[...], ...], row by row.
Json matrix(const Eigen::MatrixXd& values);
Eigen::MatrixXd matrix_of(const Json& rows);

/// {"lambda_alpha": 0.1, ...}: a point with its names, in order.
Json point(const std::vector<std::string>& names, const Eigen::VectorXd& values);
Eigen::VectorXd point_of(const std::vector<std::string>& names, const Json& object);

/// The text of a result as every file and every --json has it.
std::string text_of(const Json& value);

}  // namespace sepcal
