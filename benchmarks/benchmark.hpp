// SPDX-License-Identifier: BSD-3-Clause
// What the parts of sepcal_benchmark share.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace benchmark {

using Answer = std::vector<double>;

/// Runs a method `repeats` times; prints the seconds of the fastest and its answer in one line.
void report(int repeats, const std::function<Answer()>& run);

/// Output error of a short period. numbers: 1000 rows of time, elevator, alpha_m, q_m, az_m. The
/// answer: Za Ma Mq Zd Md b_alpha b_q b_az alpha_0 q_0. Returns false for another method.
bool run_output_error(const std::string& method, const std::vector<double>& numbers, int repeats);

/// A smoother of four states and two outputs. numbers: x0, P0, C, R; then a sample: Phi, Q_d, y.
/// The answer: x(k|N), four numbers a sample.
bool run_smoother(const std::string& method, const std::vector<double>& numbers, int repeats);

}  // namespace benchmark
