// SPDX-License-Identifier: BSD-3-Clause
// The options of fit that both apps share, as text until the command line is whole.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "log_arguments.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal::app {

class FitArguments {
 public:
  /// Adds the options to `fit`; they fill this object, which must outlive the parsing.
  void add_to(CLI::App& fit);

  /// The options of the calibration. Throws Error for a text that doesn't mean anything; names of
  /// parameters, outputs and segments are checked where the model and the flight are known.
  CalibrationOptions resolve() const;

 private:
  std::vector<std::string> effects_;
  std::vector<std::string> bounds_;
  std::vector<std::string> fixed_;
  std::vector<std::string> noise_;
  std::vector<std::string> priors_;
  std::string search_ = std::string(to_string(Search::sampling));
  std::string sampling_ = std::string(to_string(Sampling::uniform));
  std::string second_stage_ = std::string(to_string(SecondStage::automatic));
  std::string jacobian_ = std::string(to_string(ProjectedJacobian::kaufman));
  std::string loss_ = std::string(to_string(Loss::squares));
  LogArguments log_;
  CalibrationOptions options_;  // what needs no more than CLI11's reading
};

}  // namespace sepcal::app
