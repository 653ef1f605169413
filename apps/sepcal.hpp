// SPDX-License-Identifier: BSD-3-Clause
// `sepcal COMMAND`: the native front door. What needs Python is said to be there.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/flight/flight.hpp"

namespace sepcal::app {

/// The programs of a process by the names of their commands.
struct NamedProgram {
  std::string_view name;
  std::function<int(const std::string& called, int argc, char** argv)> run;  // as in programs.hpp
  std::function<std::string()> table;
};

/// Runs `sepcal COMMAND ...` and returns its exit code. `others` are the tables of commands that
/// are not here.
int run_sepcal(const std::vector<NamedProgram>& programs, const std::vector<std::string>& others,
               int argc, char** argv);

/// The instrument whose columns a flight has, and why it is taken for that one.
struct Guess {
  std::string command;  // "mag", or empty where there is none
  std::string reason;
};
Guess guess_instrument(const Flight& flight);

}  // namespace sepcal::app
