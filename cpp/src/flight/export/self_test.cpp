// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/self_test.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "sepcal/error.hpp"
#include "sepcal/flight/apply.hpp"

namespace sepcal::exporting {
namespace {

constexpr std::size_t trial_rows = 3;

/// The trials as a flight, under the names that apply() reads.
Flight trial_flight(const ProbeBody& body, const Correction& correction) {
  Flight flight("the self-test");
  std::size_t column = 0;
  for (const Quantities& one : body.readings) {
    for (const std::string& header : one.headers) {
      std::vector<double> values;
      for (std::size_t row = 0; row < trial_rows; ++row) values.push_back(body.trials[row][column]);
      flight.add(header, std::move(values));
      ++column;
    }
  }
  for (const Driver& driver : correction.drivers) {
    std::string header = driver.is_state ? driver.argument : driver.channel;
    if (driver.channel == "roll" || driver.channel == "pitch" || driver.channel == "yaw") {
      header = driver.channel;  // no state of a correction: found by its whole name
    }
    if (flight.find(header) == nullptr) flight.add(header, driver.trial);
  }
  return flight;
}

/// The corrected trials, by output and row.
std::vector<CorrectedColumn> correct_trials(const Calibration& calibration, const ProbeBody& body,
                                            const Correction& correction) {
  Calibration alone = calibration;
  alone.options.log = {};  // of another log
  std::vector<CorrectedColumn> columns = apply(alone, trial_flight(body, correction));
  for (const CorrectedColumn& column : columns) {
    for (const double value : column.values) {
      if (!std::isfinite(value)) {
        throw Error(
            "the calibration corrects plain readings to what is no number, so that it can't be "
            "exported; look at its parameters and fit it again");
      }
    }
  }
  return columns;
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

}  // namespace

std::string self_test(const Calibration& calibration, const ProbeBody& body,
                      const Correction& correction, const Dialect& dialect) {
  const std::vector<CorrectedColumn> corrected = correct_trials(calibration, body, correction);
  const std::string type = dialect.is_cpp() ? "constexpr double" : "static const double";
  std::size_t inputs = correction.drivers.size();
  for (const Quantities& one : body.readings) inputs += static_cast<std::size_t>(one.size);
  std::vector<std::string> given;
  std::vector<std::string> expected;
  for (std::size_t row = 0; row < trial_rows; ++row) {
    std::vector<std::string> numbers;
    for (const double value : body.trials[row]) numbers.push_back(literal(value));
    for (const Driver& driver : correction.drivers) numbers.push_back(literal(driver.trial[row]));
    given.push_back(fmt::format("      {{{}}}", fmt::join(numbers, ", ")));
    numbers.clear();
    for (const CorrectedColumn& column : corrected) numbers.push_back(literal(column.values[row]));
    expected.push_back(fmt::format("      {{{}}}", fmt::join(numbers, ", ")));
  }
  const std::string call = call_with(body, correction, dialect);
  return "/* 0 where the correction gives what sepcal gave of the same three inputs, to 1e-11, "
         "and\n"
         "   says so where an input is no number or far too large. */\n" +
         dialect.function("int", "self_test", {}) +
         fmt::format(
             "  {0} in[3][{1}] = {{\n{2}}};\n"
             "  {0} out[3][{3}] = {{\n{4}}};\n"
             "  double at[{1}];\n  double got[{3}];\n  int row;\n  int k;\n"
             "  for (row = 0; row < 3; ++row) {{\n"
             "    for (k = 0; k < {1}; ++k) at[k] = in[row][k];\n"
             "    if ({5} != {6}) return 1;\n"
             "    for (k = 0; k < {3}; ++k) {{\n"
             "      if (!(fabs(got[k] - out[row][k]) <= 1e-11 * (1.0 + fabs(out[row][k])))) return "
             "1;\n"
             "    }}\n  }}\n"
             "  for (row = 0; row < {1}; ++row) {{\n"
             "    for (k = 0; k < {1}; ++k) at[k] = k == row ? NAN : in[0][k];\n"
             "    if ({5} != {7}) return 1;\n"
             "    at[row] = 1e308;\n"
             "    if ({5} != {6}) continue;\n"
             "    for (k = 0; k < {3}; ++k) {{\n"
             "      if (!isfinite(got[k])) return 1;\n"
             "    }}\n  }}\n  return 0;\n}}\n",
             type, inputs, fmt::join(given, ",\n"), corrected.size(), fmt::join(expected, ",\n"),
             call, dialect.own("ok"), dialect.own("bad_input"));
}

}  // namespace sepcal::exporting
