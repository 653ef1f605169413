// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/json_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <vector>

#include "base/utf8.hpp"

namespace sepcal::files {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// What no header of a log holds either. Other marks that are not printed are escaped where they
/// leave.
bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }

}  // namespace

Json parse_json(std::string_view text, const std::string& source) {
  // What begins with it is no JSON to begin with; behind JSON it would end the text unseen.
  if (const std::size_t at = text.find('\0', 1); at != std::string_view::npos) {
    throw Error(fmt::format("{}: byte {} is NUL, which JSON has nowhere", source, at));
  }
  constexpr int deepest = 64;
  constexpr std::array<std::string_view, 5> free_texts{"file", "flight", "label", "message",
                                                       "where"};
  std::string key;
  std::vector<std::set<std::string, std::less<>>> names;  // of each object that is open
  const auto check = [&](int depth, Json::parse_event_t event, const Json& value) {
    using Event = Json::parse_event_t;
    if (depth >= deepest && (event == Event::object_start || event == Event::array_start)) {
      throw Error(
          fmt::format("{} is nested more than {} deep, as no file of sepcal is", source, deepest));
    }
    if (event == Event::object_start) names.emplace_back();
    if (event == Event::object_end) names.pop_back();
    if (event != Event::key && !value.is_string()) return true;
    if (event != Event::key && event != Event::value) return true;
    const auto& said = value.get_ref<const std::string&>();
    const bool is_free =
        event == Event::value && std::ranges::find(free_texts, key) != free_texts.end();
    if (!is_free && std::ranges::any_of(said, is_control)) {
      throw Error(fmt::format("{}: '{}' holds characters that can't be printed", source,
                              said.substr(0, 60)));
    }
    if (event != Event::key) return true;
    key = said;
    if (!names.back().insert(key).second) {
      throw Error(fmt::format("{}: one object has '{}' twice", source, key));
    }
    return true;
  };
  return Json::parse(text, check, false);
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

double number_or(const Json& value, double missing) {
  return value.is_null() ? missing : value.get<double>();
}

std::string sha256_of(const Json& value) {
  const auto& digits = value.get_ref<const std::string&>();
  const bool is_hash = digits.size() == 64 && std::ranges::all_of(digits, [](char c) {
                         return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
                       });
  if (is_hash || digits.empty()) return digits;
  throw Error(describe(value) + " stands where the 64 digits of a sha256 should");
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
    const auto at = static_cast<Index>(i);
    object[names[i]] = at < values.size() ? number(values[at]) : Json(nullptr);
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
