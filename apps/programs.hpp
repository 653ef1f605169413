// SPDX-License-Identifier: BSD-3-Clause
// The programs as functions, for their own mains, for `sepcal` and for the Python modules: each
// reads what was typed after the first word, does it and returns the exit code. `called` opens
// messages and help: "sepcal-mag", or "sepcal mag".
#pragma once

#include <string>

namespace sepcal::app {

int run_pitot(const std::string& called, int argc, char** argv);
int run_mag(const std::string& called, int argc, char** argv);
int run_aircraft(const std::string& called, int argc, char** argv);

/// What each can be asked, as tables.hpp has it.
std::string pitot_table();
std::string mag_table();
std::string aircraft_table();

}  // namespace sepcal::app
