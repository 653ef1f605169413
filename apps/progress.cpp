// SPDX-License-Identifier: BSD-3-Clause
#include "progress.hpp"

#include <unistd.h>

#include "manners.hpp"
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
  if (now < next_ || manners().quiet) return;
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

Flight read_told(const std::string& file, const std::function<Flight(const Progress& show)>& read) {
  const auto begun = std::chrono::steady_clock::now();
  ProgressLine line;
  Flight flight = read([&](double fraction) { line.show("reading " + file, fraction); });
  line.clear();
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begun;
  tell_more(page("read {}: {} rows, {} columns, {:.2f} s\n", file, flight.rows(),
                 flight.columns().size(), elapsed.count()));
  return flight;
}

}  // namespace sepcal::app
