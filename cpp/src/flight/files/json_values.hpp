// SPDX-License-Identifier: BSD-3-Clause
// Numbers and names to and from JSON: undefined and infinite numbers are null, keys keep their
// order.
#pragma once

#include <Eigen/Core>
#include <concepts>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sepcal/error.hpp"

namespace sepcal::files {

using Json = nlohmann::ordered_json;

/// Reads a file's text; discarded where it is no JSON. Throws Error that begins with `source` where
/// it nests deeper than 64, or where a name or a text steers a terminal or ends a line: a file's
/// name, a message and a condition on rows may, and are escaped where they are shown.
Json parse_json(std::string_view text, const std::string& source);

/// null for NaN and infinities.
Json number(double value);

/// The number, or `missing` for null. Throws Json::exception for anything else.
double number_or(const Json& value, double missing);

/// What a message says of a value: itself, cut where it is long, or "a list", "an object".
std::string describe(const Json& value);

/// A whole number that T can hold. Throws Error for anything else.
template <std::integral T>
T whole_number(const Json& value) {
  if (value.is_number_unsigned() && std::in_range<T>(value.get<std::uint64_t>())) {
    return static_cast<T>(value.get<std::uint64_t>());
  }
  if (value.is_number_integer() && std::in_range<T>(value.get<std::int64_t>())) {
    return static_cast<T>(value.get<std::int64_t>());
  }
  throw Error(describe(value) + " stands where a whole number should");
}

/// 64 hexadecimal digits, or empty where no file was read. Throws Error for anything else.
std::string sha256_of(const Json& value);

/// The entries of an object, and the elements of a list. Throw Json::exception for anything else.
inline const auto& entries_of(const Json& object) {
  return object.get_ref<const Json::object_t&>();
}
inline const auto& elements_of(const Json& list) { return list.get_ref<const Json::array_t&>(); }

/// [[...], ...], row by row.
Json matrix(const Eigen::MatrixXd& values);

/// Throws Error unless the rows are `n` of `n` numbers.
Eigen::MatrixXd matrix_of(const Json& rows, Eigen::Index n);

/// {"lambda_alpha": 0.1, ...}: a point with its names, in order; null where it ends before them.
Json point(const std::vector<std::string>& names, const Eigen::VectorXd& values);
Eigen::VectorXd point_of(const std::vector<std::string>& names, const Json& object);

/// The text of a result as every file and every --json has it.
std::string text_of(const Json& value);

}  // namespace sepcal::files
