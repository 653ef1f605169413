// SPDX-License-Identifier: BSD-3-Clause
#include "terminal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>

#include "sepcal/error.hpp"

namespace sepcal::app {

using base::page;

namespace {

/// A file that is opened while a stream is closed takes its number, and what is said then goes into
/// the file. Nothing can be printed on what stands in for standard output: that is told as before.
void open_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) != -1) continue;
    const int flags = stream == STDERR_FILENO ? O_WRONLY : O_RDONLY;
    [[maybe_unused]] const int lowest = ::open("/dev/null", flags);  // the stream's own number
  }
}

}  // namespace

int start(const char* app, const std::function<int()>& perform) try {
  open_streams();
  return perform();
} catch (...) {
  std::fputs(app, stderr);
  std::fputs(": memory ran out\n", stderr);
  return 2;
}

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
