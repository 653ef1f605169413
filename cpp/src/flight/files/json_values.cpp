// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/json_values.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/utf8.hpp"

namespace sepcal::files {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

double number_or(const Json& value, double missing) {
  return value.is_null() ? missing : value.get<double>();
}

/// No dump of what is nested: that takes stack by the level, and a file may have a million.
std::string describe(const Json& value) {
  constexpr std::size_t longest = 60;
  if (value.is_array()) return "a list";
  if (value.is_object()) return "an object";
  const std::string text = value.dump();
  std::size_t end = 0;
  while (end < std::min(text.size(), longest)) end += base::utf8_length(text, end);
  return end < text.size() ? text.substr(0, end) + "..." : text;
}

Json matrix(const MatrixXd& values) {
  Json rows = Json::array();
  for (Index i = 0; i < values.rows(); ++i) {
    Json row = Json::array();
    for (Index k = 0; k < values.cols(); ++k) row.push_back(number(values(i, k)));
    rows.push_back(std::move(row));
  }
  return rows;
}

MatrixXd matrix_of(const Json& rows, Index n) {
  const auto size = static_cast<std::size_t>(n);
  const auto is_whole = [size](const Json& row) { return elements_of(row).size() == size; };
  if (elements_of(rows).size() != size || !std::ranges::all_of(elements_of(rows), is_whole)) {
    throw Error("the matrix of correlations is not " + std::to_string(n) + " by " +
                std::to_string(n));
  }
  MatrixXd values(n, n);
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t k = 0; k < size; ++k) {
      values(static_cast<Index>(i), static_cast<Index>(k)) =
          number_or(rows.at(i).at(k), std::numeric_limits<double>::quiet_NaN());
    }
  }
  return values;
}

Json point(const std::vector<std::string>& names, const VectorXd& values) {
  Json object = Json::object();
  for (std::size_t i = 0; i < names.size(); ++i) {
    object[names[i]] = number(values[static_cast<Index>(i)]);
  }
  return object;
}

VectorXd point_of(const std::vector<std::string>& names, const Json& object) {
  VectorXd values(static_cast<Index>(names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) {
    values[static_cast<Index>(i)] = object.at(names[i]).get<double>();
  }
  return values;
}

std::string text_of(const Json& value) {
  return value.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sepcal::files
