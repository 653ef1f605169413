// SPDX-License-Identifier: BSD-3-Clause
#include "terminal.hpp"

#include <cstdio>

#include "sepcal/error.hpp"

namespace sepcal::app {

using base::page;

void print(const std::string& result) {
  const bool written = std::fwrite(result.data(), 1, result.size(), stdout) == result.size();
  if (!written || std::fflush(stdout) != 0) {
    throw Error("standard output can't be written; is the disc full?");
  }
}

void print(const base::Page& page) { print(page.text()); }

void tell(const base::Page& page) {
  const std::string& text = page.text();
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void tell_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) tell(page("note: {}\n", note));
}

}  // namespace sepcal::app
