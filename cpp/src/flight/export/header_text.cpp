// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/header_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/escaping.hpp"
#include "flight/export/probe_body.hpp"
#include "flight/export/self_test.hpp"

namespace sepcal::exporting {

using base::in_c_comment;

namespace {

/// A function's array argument in C and C++: its size is for the reader.
std::string declared(const Quantities& one, bool output) {
  if (output) return one.size == 1 ? "double *" + one.argument : "double " + one.argument + "[3]";
  return one.size == 1 ? "double " + one.argument : "const double " + one.argument + "[3]";
}

std::vector<std::string> arguments_of(const ProbeBody& body, const Correction& correction) {
  std::vector<std::string> arguments;
  for (const Quantities& one : body.readings) arguments.push_back(declared(one, false));
  for (const Driver& driver : correction.drivers) {
    arguments.push_back("double " + driver.argument);
  }
  for (const Quantities& one : body.outputs) arguments.push_back(declared(one, true));
  return arguments;
}

/// The function that every spline is read by; a straight line beyond its end knots.
std::string spline_function(const Dialect& dialect) {
  return dialect.function("double", "spline",
                          {"double x", "int count", "const double *knots", "const double *values",
                           "const double *curvatures"}) +
         "  int i = 0;\n"
         "  double inside = x;\n"
         "  if (inside < knots[0]) inside = knots[0];\n"
         "  if (inside > knots[count - 1]) inside = knots[count - 1];\n"
         "  while (i < count - 2 && inside >= knots[i + 1]) ++i;\n"
         "  const double h = knots[i + 1] - knots[i];\n"
         "  const double t = inside - knots[i];\n"
         "  const double third = (curvatures[i + 1] - curvatures[i]) / h;\n"
         "  const double start = (values[i + 1] - values[i]) / h -\n"
         "                       h * (2.0 * curvatures[i] + curvatures[i + 1]) / 6.0;\n"
         "  const double slope = start + t * (curvatures[i] + 0.5 * t * third);\n"
         "  return values[i] + t * (start + t * (0.5 * curvatures[i] + t * third / 6.0)) +\n"
         "         (x - inside) * slope;\n}\n\n";
}

std::string explain_arguments(const ProbeBody& body, const Correction& correction) {
  std::string text = "/* " + in_c_comment(body.summary) + ".\n";
  const auto add = [&](const std::string& name, const std::string& what) {
    text += fmt::format("     {}: {}\n", in_c_comment(name), in_c_comment(what));
  };
  for (const Quantities& one : body.readings) add(one.argument, one.comment);
  for (const Driver& driver : correction.drivers) {
    add(driver.argument,
        driver.is_state ? driver.comment : fmt::format("{}, {}", driver.channel, driver.comment));
  }
  for (const Quantities& one : body.outputs) add(one.argument, "output, " + one.comment);
  return text + "*/\n";
}

/// Each number of an argument; one alone is had by `alone`.
std::vector<std::string> numbers_of(const Quantities& one, const char* alone) {
  if (one.size == 1) return {alone + one.argument};
  std::vector<std::string> numbers;
  for (int i = 0; i < one.size; ++i) numbers.push_back(fmt::format("{}[{}]", one.argument, i));
  return numbers;
}

std::string check_finite(const std::string& value, const Dialect& dialect, const char* status) {
  return fmt::format("  if (!isfinite({})) return {};\n", value, dialect.own(status));
}

std::string check_inputs(const ProbeBody& body, const Correction& correction,
                         const Dialect& dialect) {
  std::string text;
  for (const Quantities& one : body.readings) {
    for (const std::string& input : numbers_of(one, "")) {
      text += check_finite(input, dialect, "bad_input");
    }
  }
  for (const Driver& driver : correction.drivers) {
    text += check_finite(driver.argument, dialect, "bad_input");
  }
  return text;
}

/// Inputs far beyond any reading overflow on the way.
std::string check_outputs(const ProbeBody& body, const Dialect& dialect) {
  std::string text;
  for (const Quantities& one : body.outputs) {
    for (const std::string& output : numbers_of(one, "*")) {
      text += check_finite(output, dialect, "no_solution");
    }
  }
  return text + fmt::format("  return {};\n", dialect.own("ok"));
}

/// What a five-hole probe reads before anything is corrected: effects may follow it.
std::string read_angles(const Calibration& calibration, const Dialect& dialect) {
  if (calibration.probe->name() != "five-hole") return "";
  return fmt::format(
      "  const double pressure = pt_pa - ps_pa;\n"
      "  if (!(pressure > 0.0) || !(rho_kgpm3 > 0.0)) return {};\n"
      "  const double alpha_read = dpa_pa / ({} * pressure);\n"
      "  const double beta_read = dpb_pa / ({} * pressure);\n",
      dialect.own("bad_input"), dialect.constant("k_alpha"), dialect.constant("k_beta"));
}

std::string define_constants(const ProbeBody& body, const Correction& correction,
                             const Dialect& dialect) {
  std::string text = dialect.is_cpp() ? "namespace constants {\n\n" : "";
  for (const auto* const list : {&body.constants, &correction.constants}) {
    for (const Constant& one : *list) {
      text += dialect.define(one.name, one.values, one.columns, one.comment);
    }
  }
  return text + (dialect.is_cpp() ? "\n} /* namespace constants */\n\n" : "\n");
}

}  // namespace

Header header_text(const Calibration& calibration, const Dialect& dialect,
                   const std::vector<std::string>& comment) {
  const Correction correction = describe_correction(calibration, dialect);
  const ProbeBody body = body_of(calibration, correction, dialect);
  std::string text = "/*\n";
  for (const std::string& line : comment) text += fmt::format(" * {}\n", in_c_comment(line));
  for (const std::string& effect : correction.left_to_others) {
    text +=
        fmt::format(" * {}: on the reference or the wind, not on the reading: no part of this\n",
                    in_c_comment(effect));
  }
  text += " */\n" + dialect.opening() + define_constants(body, correction, dialect);
  if (correction.has_splines) text += spline_function(dialect);
  text += explain_arguments(body, correction);
  text += dialect.function(dialect.status_type(), "correct", arguments_of(body, correction));
  text += check_inputs(body, correction, dialect) + read_angles(calibration, dialect);
  for (const std::string& statement : correction.statements) {
    text += "  " + statement + "\n";
  }
  text += body.text + check_outputs(body, dialect) + "}\n\n";
  text += self_test(calibration, body, correction, dialect);
  return {text + dialect.closing(), correction.left_to_others};
}

}  // namespace sepcal::exporting
