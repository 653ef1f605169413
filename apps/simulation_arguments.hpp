// SPDX-License-Identifier: BSD-3-Clause
// The options of simulate that both apps share, as text until the command line is whole.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "instrument.hpp"

namespace sepcal::app {

class SimulationArguments {
 public:
  /// Adds the options to `simulate`; they fill this object, which must outlive the parsing.
  void add_to(CLI::App& simulate);

  /// What to simulate, but for the truth. Throws Error for a text that doesn't mean anything; the
  /// effects' names are checked where the probe is known.
  SimulationOrder resolve() const;

 private:
  std::vector<std::string> hidden_;
  std::string excitation_ = "rich";
  std::string noise_ = "white";
  SimulationOptions options_;  // what needs no more than CLI11's reading
};

}  // namespace sepcal::app
