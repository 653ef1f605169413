// SPDX-License-Identifier: BSD-3-Clause
#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

namespace sepcal::app {

using namespace std::chrono_literals;

namespace {

constexpr auto between_lines = 10s;  // where nothing can be rewritten

}  // namespace

ProgressLine::ProgressLine()
    : terminal_(isatty(STDERR_FILENO) == 1),
      next_(Clock::now() + (terminal_ ? Clock::duration(500ms) : between_lines)) {}

void ProgressLine::show(std::string_view task, double fraction) {
  const Clock::time_point now = Clock::now();
  if (task != task_) {
    task_ = task;
    begun_ = now;
  }
  if (now < next_) return;
  next_ = now + (terminal_ ? Clock::duration(100ms) : between_lines);
  std::string line = fmt::format("{}: {:3.0f} %", task, 100.0 * fraction);
  const double elapsed = std::chrono::duration<double>(now - begun_).count();
  if (fraction > 0.0 && elapsed > 1.0) {
    line += fmt::format(", about {:.0f} s left", elapsed * (1.0 - fraction) / fraction);
  }
  if (terminal_) {
    fmt::print(stderr, "\r\033[K{}", line);
    shown_ = true;
  } else {
    fmt::print(stderr, "{}\n", line);
  }
  std::fflush(stderr);
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
