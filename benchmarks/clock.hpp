// SPDX-License-Identifier: BSD-3-Clause
// How every program of the benchmark measures, reads and answers.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace benchmark {

using Answer = std::vector<double>;

/// CPU time of this thread [s].
double thread_seconds();

/// Runs a method `repeats` times; prints the seconds of the fastest and its answer in one line.
void report(int repeats, const std::function<Answer()>& run);

/// All doubles of a binary file. Ends the program where it can't be read.
std::vector<double> read_doubles(const char* name);

}  // namespace benchmark
