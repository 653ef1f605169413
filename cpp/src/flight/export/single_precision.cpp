// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/single_precision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sepcal/error.hpp"

namespace sepcal::exporting {
namespace {

constexpr std::array functions{"asin",  "atan2", "cos", "expm1", "fabs",
                               "log1p", "pow",   "sin", "sqrt"};

bool is_in_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Where the number at `at` ends: digits, a point, an exponent with its sign.
std::size_t end_of_number(std::string_view code, std::size_t at) {
  while (at < code.size()) {
    const bool sign = (code[at] == '+' || code[at] == '-') && code[at - 1] == 'e';
    if (!is_digit(code[at]) && code[at] != '.' && code[at] != 'e' && !sign) break;
    ++at;
  }
  return at;
}

std::string single_word(std::string_view word) {
  if (word == "double") return "float";
  const bool is_function = std::ranges::find(functions, word) != functions.end();
  return std::string(word) + (is_function ? "f" : "");
}

}  // namespace

double to_single(double value) {
  if (std::abs(value) > static_cast<double>(std::numeric_limits<float>::max())) {
    throw Error(fmt::format(
        "the calibration has {:.6g}, which is beyond what a float holds; export it in double",
        value));
  }
  return static_cast<double>(static_cast<float>(value));
}

std::string in_single_precision(std::string_view code) {
  std::string text;
  std::size_t at = 0;
  while (at < code.size()) {
    std::size_t end = at + 1;
    if (code.substr(at).starts_with("/*")) {
      end = std::min(code.find("*/", at), code.size() - 2) + 2;
      text += code.substr(at, end - at);
    } else if (is_digit(code[at])) {
      end = end_of_number(code, at);
      const std::string_view number = code.substr(at, end - at);
      text += number;
      if (number.find_first_of(".e") != std::string_view::npos) text += 'f';
    } else if (is_in_name(code[at])) {
      while (end < code.size() && is_in_name(code[end])) ++end;
      text += single_word(code.substr(at, end - at));
    } else {
      text += code[at];
    }
    at = end;
  }
  return text;
}

}  // namespace sepcal::exporting
