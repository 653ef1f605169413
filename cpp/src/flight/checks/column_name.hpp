// SPDX-License-Identifier: BSD-3-Clause
// A column as a condition on rows names it (row_expression.hpp).
#pragma once

#include <algorithm>
#include <string>

namespace sepcal::checks {

/// In backquotes where the header is no name.
inline std::string quote(const std::string& header) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  const bool is_name =
      !header.empty() && is_letter(header.front()) &&
      std::ranges::all_of(header, [&](char c) { return is_letter(c) || is_digit(c) || c == '.'; });
  return is_name ? header : "`" + header + "`";
}

}  // namespace sepcal::checks
