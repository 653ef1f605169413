// SPDX-License-Identifier: BSD-3-Clause
// The options of diagnose that all apps share, and what its verdict is as an exit code.
#pragma once

#include <CLI/App.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sepcal/flight/stepwise.hpp"

namespace sepcal::app {

/// 0 nothing is missing, 3 an effect is, 6 a slow change or what no candidate explains.
int exit_code(Verdict verdict);

class DiagnoseArguments {
 public:
  /// Adds the options to `diagnose`; they fill this object, which must outlive the parsing.
  void add_to(CLI::App& diagnose);

  /// Whether what is missing is to be added as well.
  bool adds() const { return adds_; }

  /// What is put into the measurements first. Throws Error for another form, and with --auto.
  std::optional<SizedEffect> injected() const;

  /// Throws Error for a choice that there isn't and for options that contradict each other.
  StepwiseOptions resolve() const;

 private:
  bool adds_ = false;
  std::string inject_;  // "E=SIZE", or empty
  std::optional<std::size_t> most_;
  std::vector<std::string> only_;
  std::vector<std::string> error_budget_;
  std::string within_;
  std::string pse_ = std::string(to_string(PseBound::sidpac));
  std::string rule_ = std::string(to_string(DiagnosisRule::verdict));
};

}  // namespace sepcal::app
