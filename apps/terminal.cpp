// SPDX-License-Identifier: BSD-3-Clause
#include "terminal.hpp"

#include <unistd.h>

#include <cstdio>

#include "layout.hpp"
#include "manners.hpp"
#include "sepcal/error.hpp"

namespace sepcal::app {

using base::page;

namespace {

void write_error(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

/// A line with its first word in colour, where that shows; broken at a terminal's width.
void tell_line(const std::string& first, Colour colour, const base::Page& rest) {
  const std::string line = laid_out(first + " " + rest.text(), width_of(STDERR_FILENO));
  const std::string begun = takes_colour(STDERR_FILENO) ? in_colour(colour, first) : first;
  write_error(begun + line.substr(first.size()) + "\n");
}

}  // namespace

void print(const std::string& result) {
  const bool written = std::fwrite(result.data(), 1, result.size(), stdout) == result.size();
  if (!written || std::fflush(stdout) != 0) {
    throw Error("standard output can't be written; is the disc full?");
  }
}

void print(const base::Page& page) { print(page.text()); }

void show(const std::string& text) {
  if (manners().quiet || !manners().shows_page) return;
  const std::string page = laid_out(text, width_of(STDOUT_FILENO));
  print(takes_colour(STDOUT_FILENO) ? coloured(page) : page);
}

void show(const base::Page& page) { show(page.text()); }

void tell(const base::Page& page) { write_error(page.text()); }

void tell_refusal(const std::string& called, const std::string& what) {
  tell_line(called + ":", Colour::red, page("{}", what));
}

void tell_notes(const std::vector<std::string>& notes) {
  if (manners().quiet) return;
  for (const std::string& note : notes) tell_line("note:", Colour::yellow, page("{}", note));
}

void tell_more(const base::Page& page) {
  if (manners().verbose && !manners().quiet) tell(page);
}

}  // namespace sepcal::app
