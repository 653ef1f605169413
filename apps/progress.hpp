// SPDX-License-Identifier: BSD-3-Clause
// One line on standard error that says what is being done, where standard error is a terminal.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "sepcal/options.hpp"

namespace sepcal::app {

class ProgressLine {
 public:
  ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine() { clear(); }

  /// Rewrites the line, at most ten times a second and not before half a second has passed: short
  /// work shows nothing.
  void show(std::string_view task, double fraction);

  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  bool terminal_;
  bool shown_ = false;
  Clock::time_point next_;
};

/// What a fit reports, shown on the line.
FitProgress shown_on(ProgressLine& line);

}  // namespace sepcal::app
