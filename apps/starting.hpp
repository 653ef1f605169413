// SPDX-License-Identifier: BSD-3-Clause
// How a program of its own begins: with its three streams open, and with a line for memory that
// runs out before there is a command line. A module of Python has begun already, and has none of
// it.
#pragma once

#include <functional>

namespace sepcal::app {

/// Does what a program is for and returns its exit code. What ends it before the command line is
/// there is one line.
int start(const char* program_name, const std::function<int()>& perform);

}  // namespace sepcal::app
