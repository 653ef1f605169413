// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/self_test.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "flight/export/trials.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/apply.hpp"

namespace sepcal::exporting {
namespace {

std::vector<CorrectedColumn> correct_trials(const Calibration& calibration, const Trials& trials) {
  Calibration alone = calibration;
  alone.options.log = {};  // of another log
  return apply(alone, trials.flight());
}

bool is_corrected(const std::vector<CorrectedColumn>& columns, std::size_t row) {
  return std::ranges::all_of(
      columns, [row](const CorrectedColumn& one) { return std::isfinite(one.values[row]); });
}

/// What the rows are corrected to, a number an output. Rows beyond what the fit saw in which
/// nothing can be corrected are dropped. Throws Error where that holds of a plain one.
std::vector<CorrectedColumn> expected_of(const Calibration& calibration, Trials& trials) {
  std::vector<CorrectedColumn> columns = correct_trials(calibration, trials);
  for (std::size_t row = trials.rows(); row-- > 0;) {
    if (is_corrected(columns, row)) continue;
    if (row < plain_rows) {
      throw Error(
          "the calibration corrects plain readings to what is no number, so that it can't be "
          "exported; look at its parameters and fit it again");
    }
    trials.drop(row);
    for (CorrectedColumn& column : columns) {
      column.values.erase(column.values.begin() + static_cast<std::ptrdiff_t>(row));
    }
  }
  return columns;
}

/// By how much an output may be off, each: in double 1e-11 of 1 and the largest, in float 1e-6 of
/// the largest reading and output in its unit, of an angle 1e-6 rad.
std::vector<double> tolerances(const ProbeBody& body, const Trials& trials,
                               const std::vector<CorrectedColumn>& expected, bool single) {
  std::vector<double> sizes;
  for (const CorrectedColumn& column : expected) {
    double largest = 1.0;
    for (const double value : column.values) largest = std::max(largest, std::abs(value));
    sizes.push_back(largest);
  }
  const Quantities& read = body.readings.front();
  if (body.outputs.front().size == 3) {  // a field: its components are one quantity
    double largest = std::ranges::max(sizes);
    for (std::size_t row = 0; row < trials.rows(); ++row) {
      const std::vector<double> inputs = trials.inputs(row);
      for (int i = 0; i < read.size; ++i) {
        largest = std::max(largest, std::abs(inputs[static_cast<std::size_t>(i)]));
      }
    }
    std::ranges::fill(sizes, largest);
  }
  for (double& size : sizes) size *= single ? 1e-6 : 1e-11;
  return sizes;
}

/// Of the inputs at[] into the outputs got[].
std::string call_with(const ProbeBody& body, const Correction& correction, const Dialect& dialect) {
  std::vector<std::string> arguments;
  std::size_t at = 0;
  for (const Quantities& one : body.readings) {
    arguments.push_back(fmt::format("{}at[{}]", one.size == 1 ? "" : "&", at));
    at += static_cast<std::size_t>(one.size);
  }
  for (std::size_t i = 0; i < correction.drivers.size(); ++i) {
    arguments.push_back(fmt::format("at[{}]", at + i));
  }
  at = 0;
  for (const Quantities& one : body.outputs) {
    arguments.push_back(fmt::format("&got[{}]", at));
    at += static_cast<std::size_t>(one.size);
  }
  return fmt::format("{}({})", dialect.own("correct"), fmt::join(arguments, ", "));
}

std::string row_of(const std::vector<double>& values, const Dialect& dialect) {
  std::vector<std::string> numbers;
  for (const double value : values) numbers.push_back(dialect.literal(value));
  return fmt::format("{{{}}}", fmt::join(numbers, ", "));
}

}  // namespace

std::string self_test(const Calibration& calibration, const ProbeBody& body,
                      const Correction& correction, const Dialect& dialect) {
  const bool single = dialect.is_single();
  Trials trials(calibration, body, correction, single);
  const std::vector<CorrectedColumn> corrected = expected_of(calibration, trials);
  std::vector<std::string> given;
  std::vector<std::string> expected;
  std::vector<std::string> statuses;
  for (std::size_t row = 0; row < trials.rows(); ++row) {
    given.push_back("      " + row_of(trials.inputs(row), dialect));
    std::vector<double> outputs;
    for (const CorrectedColumn& column : corrected) outputs.push_back(column.values[row]);
    expected.push_back("      " + row_of(outputs, dialect));
    statuses.push_back(dialect.own(trials.is_outside(row) ? "outside" : "ok"));
  }
  const std::string kind = dialect.is_cpp() ? "constexpr" : "static const";
  const std::string type = single ? "float" : "double";
  return (single ? "/* 0 where the correction gives what sepcal gave of the same inputs, to a "
                   "millionth of\n"
                   "   the largest reading and output (of an angle to 1e-6 rad),"
                 : "/* 0 where the correction gives what sepcal gave of the same inputs, to 1e-11 "
                   "of the\n"
                   "   largest,") +
         std::string(
             " says so where a driver is beyond what the fit saw, and where an input\n"
             "   is no number or far too large. */\n") +
         dialect.function("int", "self_test", {}) +
         fmt::format(
             "  {kind} {type} in[{rows}][{inputs}] = {{\n{given}}};\n"
             "  {kind} {type} out[{rows}][{outputs}] = {{\n{expected}}};\n"
             "  {kind} int says[{rows}] = {{{says}}};\n"
             "  {kind} {type} size[{outputs}] = {sizes};\n"
             "  {type} at[{inputs}];\n  {type} got[{outputs}];\n"
             "  int row;\n  int k;\n  int status;\n"
             "  for (row = 0; row < {rows}; ++row) {{\n"
             "    for (k = 0; k < {inputs}; ++k) at[k] = in[row][k];\n"
             "    for (k = 0; k < {outputs}; ++k) got[k] = {none};\n"
             "    if ({call} != says[row]) return 1;\n"
             "    for (k = 0; k < {outputs}; ++k) {{\n"
             "      if (!({abs}(got[k] - out[row][k]) <= size[k])) return 1;\n"
             "    }}\n  }}\n"
             "  for (row = 0; row < {inputs}; ++row) {{\n"
             "    for (k = 0; k < {inputs}; ++k) at[k] = k == row ? {none} : in[0][k];\n"
             "    if ({call} != {bad_input}) return 1;\n"
             "    at[row] = {largest};\n"
             "    status = {call};\n"
             "    if (status != {ok} && status != {outside}) continue;\n"
             "    for (k = 0; k < {outputs}; ++k) {{\n"
             "      if (!isfinite(got[k])) return 1;\n"
             "    }}\n  }}\n  return 0;\n}}\n",
             fmt::arg("kind", kind), fmt::arg("type", type), fmt::arg("rows", trials.rows()),
             fmt::arg("inputs", trials.inputs(0).size()), fmt::arg("outputs", corrected.size()),
             fmt::arg("given", fmt::join(given, ",\n")),
             fmt::arg("expected", fmt::join(expected, ",\n")),
             fmt::arg("says", fmt::join(statuses, ", ")),
             fmt::arg("sizes", row_of(tolerances(body, trials, corrected, single), dialect)),
             fmt::arg("call", call_with(body, correction, dialect)),
             fmt::arg("abs", single ? "fabsf" : "fabs"),
             fmt::arg("none", single             ? "NAN"
                              : dialect.is_cpp() ? "double(NAN)"
                                                 : "(double)NAN"),
             fmt::arg("largest", single ? "1e38f" : "1e308"), fmt::arg("ok", dialect.own("ok")),
             fmt::arg("outside", dialect.own("outside")),
             fmt::arg("bad_input", dialect.own("bad_input")));
}

}  // namespace sepcal::exporting
