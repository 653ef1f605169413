// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/dialect.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/escaping.hpp"
#include "sepcal/error.hpp"

namespace sepcal::exporting {
namespace {

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::string row_of(const std::vector<double>& values, std::size_t first, std::size_t last) {
  std::vector<std::string> numbers;
  for (std::size_t i = first; i < last; ++i) numbers.push_back(literal(values[i]));
  return fmt::format("{{{}}}", fmt::join(numbers, ", "));
}

}  // namespace

std::string literal(double value) {
  if (!std::isfinite(value)) {
    throw Error(
        "the calibration has a number that is none: what is each flight's own is known only of "
        "the flights that were fitted; give one of them");
  }
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string Dialect::opening() const {
  const std::string guard = upper(name_) + (cpp_ ? "_HPP" : "_H");
  std::string text = fmt::format("#ifndef {0}\n#define {0}\n\n#include <math.h>\n\n", guard);
  text +=
      "#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)\n"
      "#error \"-ffast-math takes isfinite() away, which guards this correction; leave it out\"\n"
      "#endif\n\n";
  if (cpp_) text += fmt::format("namespace {} {{\n\n", name_);
  text += fmt::format(
      "/* What correct() returns. */\n"
      "enum {}{{\n"
      "  {} = 0, /* the outputs are set */\n"
      "  {} = 1, /* an input is no number, or there is nothing to correct */\n"
      "  {} = 2 /* no finite outputs belong to these inputs */\n"
      "}};\n\n",
      cpp_ ? "Status " : "", own("ok"), own("bad_input"), own("no_solution"));
  return text;
}

std::string Dialect::closing() const {
  return fmt::format(
      "\n{}#endif\n",
      cpp_ ? fmt::format("}} /* namespace {} */\n\n", base::in_c_comment(name_)) : "");
}

std::string Dialect::define(std::string_view name, const std::vector<double>& values,
                            std::size_t columns, std::string_view comment) const {
  std::string text =
      fmt::format("/* {} */\n{} double {}", base::in_c_comment(comment),
                  cpp_ ? "inline constexpr" : "static const", cpp_ ? std::string(name) : own(name));
  if (values.size() == 1 && columns == 0) {
    return text + fmt::format(" = {};\n", literal(values.front()));
  }
  if (columns == 0) {
    return text + fmt::format("[{}] = {};\n", values.size(), row_of(values, 0, values.size()));
  }
  std::vector<std::string> rows;
  for (std::size_t first = 0; first < values.size(); first += columns) {
    rows.push_back("    " + row_of(values, first, first + columns));
  }
  return text + fmt::format("[{}][{}] = {{\n{}}};\n", rows.size(), columns, fmt::join(rows, ",\n"));
}

std::string Dialect::function(std::string_view type, std::string_view name,
                              const std::vector<std::string>& arguments) const {
  constexpr std::size_t widest = 100;
  const std::string head =
      fmt::format("{} {} {}(", cpp_ ? "inline" : "static inline", type, own(name));
  const std::string on_a_line =
      arguments.empty() ? "void" : fmt::format("{}", fmt::join(arguments, ", "));
  if (head.size() + on_a_line.size() + 3 <= widest) return head + on_a_line + ") {\n";
  return fmt::format("{}\n    {}) {{\n", head, fmt::join(arguments, ",\n    "));
}

}  // namespace sepcal::exporting
