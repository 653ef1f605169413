// SPDX-License-Identifier: BSD-3-Clause
// What is being done, how far it is and about how long that will take, on standard error: one line
// that is rewritten where that is a terminal, else a line every ten seconds.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>

#include "sepcal/flight/flight.hpp"
#include "sepcal/options.hpp"

namespace sepcal::app {

class ProgressLine {
 public:
  ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine() { clear(); }

  /// Rewrites the line, at most ten times a second and not before half a second has passed: short
  /// work shows nothing. `fraction` of the task is done.
  void show(std::string_view task, double fraction);

  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  bool terminal_;
  bool shown_ = false;
  Clock::time_point next_;
  std::string task_ = {};  // since begun_
  Clock::time_point begun_ = {};
};

/// What a fit reports, shown on the line.
FitProgress shown_on(ProgressLine& line);

/// What `read` makes of a log, with its progress shown; --verbose says what came of it.
Flight read_told(const std::string& file, const std::function<Flight(const Progress& show)>& read);

}  // namespace sepcal::app
