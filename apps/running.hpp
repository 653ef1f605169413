// SPDX-License-Identifier: BSD-3-Clause
// How every app runs: what was typed is read, what it asks for is done, and whatever goes wrong is
// one line on standard error.
#pragma once

#include <CLI/App.hpp>
#include <functional>
#include <string>

#include "base/escaping.hpp"

namespace sepcal::app {

/// The exit code of bad input and of a command line that can't be read.
inline constexpr int bad_usage = 2;

/// Adds the options that every verb has, and how help is printed.
void complete(CLI::App& cli);

/// Parses the command line, calls `perform`, and maps every error to one line. Returns the exit
/// code: 0, 2, or what `perform` gives. `cli` has the app's name and its verbs.
int run(CLI::App& cli, int argc, char** argv, const std::function<int()>& perform);

using base::as_typed;

}  // namespace sepcal::app
