// SPDX-License-Identifier: BSD-3-Clause
// What was typed, as a program's main has it.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "interrupt.hpp"

namespace sepcal::bindings {

/// Runs `program(argc, argv)` with Python's other threads running, and has what it printed leave
/// the process before Python prints more. Who stops to read ends it, as any program. Returns its
/// exit code.
template <class Program>
int run_with(std::string called, std::vector<std::string> arguments, const Program& program) {
  std::vector<char*> words{called.data()};
  for (std::string& argument : arguments) words.push_back(argument.data());
  const app::SignalScope reader_is_gone(SIGPIPE, SIG_DFL);
  const py::gil_scoped_release released;
  const int code = program(static_cast<int>(words.size()), words.data());
  std::fflush(stdout);
  return code;
}

}  // namespace sepcal::bindings
