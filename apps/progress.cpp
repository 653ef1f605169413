// SPDX-License-Identifier: BSD-3-Clause
#include "progress.hpp"

#include <unistd.h>

#include "terminal.hpp"

namespace sepcal::app {

using base::Page;
using base::page;
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
  Page line = page("{}: {:3.0f} %", task, 100.0 * fraction);
  const double elapsed = std::chrono::duration<double>(now - begun_).count();
  if (fraction > 0.0 && elapsed > 1.0) {
    line += page(", about {:.0f} s left", elapsed * (1.0 - fraction) / fraction);
  }
  tell(terminal_ ? "\r\033[K" + line : line + "\n");
  shown_ = terminal_;
}

void ProgressLine::clear() {
  if (!shown_) return;
  tell("\r\033[K");
  shown_ = false;
}

FitProgress shown_on(ProgressLine& line) {
  return [&line](std::string_view task, double fraction) { line.show(task, fraction); };
}

}  // namespace sepcal::app
