// SPDX-License-Identifier: BSD-3-Clause
#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

namespace sepcal::app {

using namespace std::chrono_literals;

ProgressLine::ProgressLine() : terminal_(isatty(STDERR_FILENO) == 1), next_(Clock::now() + 500ms) {}

void ProgressLine::show(std::string_view task, double fraction) {
  if (!terminal_ || Clock::now() < next_) return;
  next_ = Clock::now() + 100ms;
  fmt::print(stderr, "\r\033[K{}: {:3.0f} %", task, 100.0 * fraction);
  std::fflush(stderr);
  shown_ = true;
}

void ProgressLine::clear() {
  if (!shown_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  shown_ = false;
}

FitProgress shown_on(ProgressLine& line) {
  return [&line](std::string_view task, double fraction) { line.show(task, fraction); };
}

}  // namespace sepcal::app
