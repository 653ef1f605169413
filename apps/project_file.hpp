// SPDX-License-Identifier: BSD-3-Clause
// sepcal.toml: what is known of a project's instruments, so that nobody types it twice.
//
//   [mag]
//   field = [19.7, -1.4, 49.4]
//   map = { mx_ut = "MagX", my_ut = "MagY", mz_ut = "MagZ" }
//
//   [five-hole]
//   k-alpha = 4.5
//   k-beta = 4.5
//   lever-arm = [0.35, 0, -0.02]
//   bounds = { w_d = [-1, 1] }
//
// A section has any option of check or fit by its long name. What is typed wins.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

namespace sepcal::app {

/// The first sepcal.toml in the folder of `flight` or in one above it; empty where there is none.
std::string find_project_file(const std::string& flight);

/// The options of `file` that are of this program and verb, as words of a command line, without
/// those that were typed: "--k-alpha=4.5". `cli` has read its command line. Throws Error for what
/// is no TOML, for a section or an option that there is not, with the one that was meant, and for a
/// value that no option takes.
std::vector<std::string> read_project(const std::string& file, const CLI::App& cli,
                                      const CLI::App& verb);

}  // namespace sepcal::app
