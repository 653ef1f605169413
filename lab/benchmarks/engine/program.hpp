// SPDX-License-Identifier: BSD-3-Clause
// How every program of the benchmark measures, reads and answers.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace benchmark {

using Answer = std::vector<double>;

/// CPU time of this thread [s].
double thread_seconds();

/// Runs a method `repeats` times; prints the seconds of the fastest and its answer in one line.
void report(int repeats, const std::function<Answer()>& run);

/// The same once, by the clock on the wall: of what runs on several threads.
void report_wall(const std::function<Answer()>& run);

/// All doubles of a binary file. Ends the program where it can't be read.
std::vector<double> read_doubles(const char* name);

/// Solves a problem by a method and reports; `numbers` are those of a file. Returns false for
/// another method.
using RunProblem = bool (*)(const std::string& method, const std::vector<double>& numbers,
                            int repeats);

/// A program's main(): its arguments are PROBLEM METHOD FILE REPEATS, FILE - for none. Returns the
/// exit code.
int run_problem(const std::map<std::string, RunProblem>& problems, int count, char** arguments);

}  // namespace benchmark
