// SPDX-License-Identifier: BSD-3-Clause
// The options that choose columns and rows of a log.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "sepcal/detail/flight/log_choice.hpp"

namespace sepcal::app {

class LogArguments {
 public:
  void add_to(CLI::App& verb);

  /// What was typed put over `choice`, whatever that says; the rest of it stays. Throws Error for
  /// text of another form.
  LogChoice over(LogChoice choice) const;

 private:
  LogChoice typed_;
  std::vector<std::string> map_;
};

}  // namespace sepcal::app
