// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/dialect.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/escaping.hpp"
#include "flight/export/single_precision.hpp"
#include "sepcal/error.hpp"

namespace sepcal::exporting {
namespace {

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

}  // namespace

std::string Dialect::row_of(const std::vector<double>& values, std::size_t first,
                            std::size_t last) const {
  std::vector<std::string> numbers;
  for (std::size_t i = first; i < last; ++i) numbers.push_back(literal(values[i]));
  return fmt::format("{{{}}}", fmt::join(numbers, ", "));
}

std::string Dialect::literal(double value) const {
  if (!std::isfinite(value)) {
    throw Error(
        "the calibration has a number that is none: what is each flight's own is known only of "
        "the flights that were fitted; give one of them");
  }
  std::string text =
      single_ ? fmt::format("{}", static_cast<float>(to_single(value))) : fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text + (single_ ? "f" : "");
}

std::string Dialect::in_precision(const std::string& code) const {
  return single_ ? in_single_precision(code) : code;
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
      "  {} = 2, /* no finite outputs belong to these inputs */\n"
      "  {} = 3 /* the outputs are set, but a driver is beyond what the fit saw of it */\n"
      "}};\n\n",
      cpp_ ? "Status " : "", own("ok"), own("bad_input"), own("no_solution"), own("outside"));
  return text;
}

std::string Dialect::closing() const {
  return fmt::format(
      "\n{}#endif\n",
      cpp_ ? fmt::format("}} /* namespace {} */\n\n", base::in_c_comment(name_)) : "");
}

std::string Dialect::define_as(std::string_view type, std::string_view name,
                               const std::string& values, std::string_view comment) const {
  return fmt::format("/* {} */\n{} {} {}{};\n", base::in_c_comment(comment),
                     cpp_ ? "inline constexpr" : "static const", type,
                     cpp_ ? std::string(name) : own(name), values);
}

std::string Dialect::define(std::string_view name, const std::vector<double>& values,
                            std::size_t columns, std::string_view comment) const {
  const std::string_view type = single_ ? "float" : "double";
  if (values.size() == 1 && columns == 0) {
    return define_as(type, name, fmt::format(" = {}", literal(values.front())), comment);
  }
  if (columns == 0) {
    const std::string row = row_of(values, 0, values.size());
    return define_as(type, name, fmt::format("[{}] = {}", values.size(), row), comment);
  }
  std::vector<std::string> rows;
  for (std::size_t first = 0; first < values.size(); first += columns) {
    rows.push_back("    " + row_of(values, first, first + columns));
  }
  return define_as(type, name,
                   fmt::format("[{}][{}] = {{\n{}}}", rows.size(), columns, fmt::join(rows, ",\n")),
                   comment);
}

std::string Dialect::define_double(std::string_view name, double value,
                                   std::string_view comment) const {
  const Dialect in_double(cpp_, false, name_);
  return define_as("double", name, fmt::format(" = {}", in_double.literal(value)), comment);
}

std::string Dialect::define_identity(std::string_view id, std::uint32_t crc) const {
  return define_as("char", "calibration_id", fmt::format("[{}] = \"{}\"", id.size() + 1, id),
                   "the SHA-256 of the calibration's JSON") +
         define_as("unsigned long", "crc", fmt::format(" = 0x{:08X}UL", crc),
                   "the CRC-32 of the constants above, in their order, each as its bytes from the "
                   "lowest");
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
