// SPDX-License-Identifier: BSD-3-Clause
// How a program speaks, as it was asked to: how much, where to, and with which exit code. Every
// verb has these options.
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace sepcal::app {

struct Manners {
  bool quiet = false;      // no page, no notes, no progress
  bool verbose = false;    // all of a page, and what was read and how long it took
  bool exit_zero = false;  // 0 in place of what a status or a verdict says
  bool shows_page = true;  // not where the result itself goes to standard output
  std::string project;     // a file of --project, or empty
};

/// Those of the program that runs. A process runs one at a time.
Manners& manners();

/// The group of options on what comes out.
inline constexpr const char* result_group = "Result and messages";

/// Whether it asks what is known of an instrument; a calibration has it for the later verbs.
bool takes_project(const CLI::App& verb);

/// Adds the options to a verb; they fill manners().
void add_manners(CLI::App& verb);

/// Where a result of the name "-" goes and a log of that name comes from.
inline constexpr const char* standard_output = "/dev/stdout";
inline constexpr const char* standard_input = "/dev/stdin";

/// Makes standard input a file that may be read twice and in any order: a pipe's bytes go to one
/// without a name in $TMPDIR (/tmp if none). Throws Error where there is no room.
void spool_standard_input();

}  // namespace sepcal::app
