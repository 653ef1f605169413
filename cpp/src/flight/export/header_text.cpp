// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/header_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/escaping.hpp"
#include "flight/export/crc32.hpp"
#include "flight/export/driver_origin.hpp"
#include "flight/export/exporter.hpp"
#include "flight/export/guards.hpp"
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

std::string explain(const Driver& driver) {
  std::string what =
      driver.is_state ? driver.comment : fmt::format("{}, {}", driver.channel, driver.comment);
  if (driver.origin == 0.0) return what;
  return fmt::format(
      "{}, less {}: take that away before it becomes a float, which has no digits "
      "for the whole",
      what, driver.origin);
}

std::string explain_guards(const Correction& correction, const Dialect& dialect) {
  std::string text;
  if (!correction.guards.empty()) {
    text += fmt::format(
        "   Beyond what the fit saw it returns {}. The outputs are set, but by a\n"
        "   curve that nobody saw there. Seen was:\n",
        dialect.own("outside"));
  }
  for (const Guard& guard : correction.guards) {
    text += fmt::format("     {} from {:.6g} to {:.6g}\n", in_c_comment(guard.channel),
                        guard.range.lower, guard.range.upper);
  }
  for (const std::string& line : correction.unguarded) {
    text += fmt::format("   {}.\n", in_c_comment(line));
  }
  return text;
}

std::string explain_arguments(const ProbeBody& body, const Correction& correction,
                              const Dialect& dialect) {
  std::string text = "/* " + in_c_comment(body.summary) + ".\n";
  const auto add = [&](const std::string& name, const std::string& what) {
    text += fmt::format("     {}: {}\n", in_c_comment(name), in_c_comment(what));
  };
  for (const Quantities& one : body.readings) add(one.argument, one.comment);
  for (const Driver& driver : correction.drivers) {
    add(driver.argument, explain(driver));
  }
  for (const Quantities& one : body.outputs) add(one.argument, "output, " + one.comment);
  return text + explain_guards(correction, dialect) + "*/\n";
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
std::string check_outputs(const ProbeBody& body, const Correction& correction,
                          const Dialect& dialect) {
  std::string text;
  for (const Quantities& one : body.outputs) {
    for (const std::string& output : numbers_of(one, "*")) {
      text += check_finite(output, dialect, "no_solution");
    }
  }
  if (correction.guards.empty()) return text + fmt::format("  return {};\n", dialect.own("ok"));
  return text + fmt::format("  return is_extrapolated ? {} : {};\n", dialect.own("outside"),
                            dialect.own("ok"));
}

/// Each with its bytes into the CRC.
class Constants {
 public:
  explicit Constants(const Dialect& dialect) : dialect_(dialect) {}

  void add(const std::vector<Constant>& list) {
    for (const Constant& one : list) {
      text_ += dialect_.define(one.name, one.values, one.columns, one.comment);
      for (const double value : one.values) {
        if (dialect_.is_single()) {
          crc_.absorb(static_cast<float>(value));
        } else {
          crc_.absorb(value);
        }
      }
    }
  }

  void add_origins(const std::vector<Driver>& drivers) {
    for (const Driver& one : drivers) {
      if (one.origin == 0.0) continue;
      std::string of = one.argument;
      of.erase(of.rfind(origin_suffix), origin_suffix.size());
      text_ += dialect_.define_double("origin_" + of, one.origin,
                                      one.channel + ": what to take away from it");
      crc_.absorb(one.origin);
    }
  }

  std::string text(const std::string& id) const {
    const bool cpp = dialect_.is_cpp();
    return (cpp ? "namespace constants {\n\n" : "") + text_ +
           (cpp ? "\n} /* namespace constants */\n\n" : "\n") +
           dialect_.define_identity(id, crc_.value()) + "\n";
  }

 private:
  const Dialect& dialect_;
  std::string text_;
  Crc32 crc_;
};

}  // namespace

Header header_text(const Calibration& calibration, const Dialect& dialect, const std::string& id,
                   const std::vector<std::string>& comment) {
  const Correction correction = describe_correction(calibration, dialect);
  const Exporter& exporter = exporter_of(calibration);
  const ProbeBody body = exporter.body(calibration, correction, dialect);
  std::string text = "/*\n";
  for (const std::string& line : comment) text += fmt::format(" * {}\n", in_c_comment(line));
  for (const std::string& effect : correction.left_to_others) {
    text +=
        fmt::format(" * {}: on the reference or the wind, not on the reading: no part of this\n",
                    in_c_comment(effect));
  }
  Constants constants(dialect);
  constants.add(body.constants);
  constants.add(correction.constants);
  constants.add(guard_constants(correction, dialect));
  constants.add_origins(correction.drivers);
  text += " */\n" + dialect.opening() + constants.text(id);
  std::string code;
  if (correction.has_splines) code += spline_function(dialect);
  code += explain_arguments(body, correction, dialect);
  code += dialect.function(dialect.status_type(), "correct", arguments_of(body, correction));
  code += check_inputs(body, correction, dialect);
  if (exporter.before_effects != nullptr) code += exporter.before_effects(dialect);
  code += guard_statement(correction, dialect);
  for (const std::string& statement : correction.statements) code += "  " + statement + "\n";
  code += body.text + check_outputs(body, correction, dialect) + "}\n\n";
  text += dialect.in_precision(code) + self_test(calibration, body, correction, dialect);
  return {text + dialect.closing(), correction.left_to_others};
}

}  // namespace sepcal::exporting
