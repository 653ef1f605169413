// SPDX-License-Identifier: BSD-3-Clause
// The options of a fit and of the log that it takes, each a row of flight/schema/option_fields.hpp.
#pragma once

#include <CLI/App.hpp>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/flight/calibration.hpp"

namespace sepcal::app {

class FitArguments {
 public:
  /// Adds the options to `fit`; they fill this object, which must outlive the parsing.
  void add_to(CLI::App& fit);

  /// Those alone that choose columns and rows of a log.
  void add_log_choice_to(CLI::App& verb);

  /// The options of the calibration. Throws Error for a text that doesn't mean anything; names of
  /// parameters, outputs and segments are checked where the model and the flight are known.
  CalibrationOptions resolve() const;

  /// What was typed of the log put over `choice`, whatever that says; the rest of it stays.
  LogChoice over(LogChoice choice) const;

 private:
  template <class Field>
  void add(CLI::App& verb, const Field& field);

  std::map<std::string_view, std::vector<std::string>> texts_;  // by name, of what is no scalar
  CalibrationOptions options_;  // what needs no more than CLI11's reading
};

}  // namespace sepcal::app
