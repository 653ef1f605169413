// SPDX-License-Identifier: BSD-3-Clause
// What the parts of sepcal_benchmark share: each solves a problem by a method, whose time and
// answer it reports. Returns false for another method.
#pragma once

#include <string>
#include <vector>

#include "program.hpp"

namespace benchmark {

/// Filter error of a short period. numbers: theta, b_alpha b_q b_az Zd Md alpha_0 q_0 Za Ma Mq,
/// then ln of two process noises and of three outputs' noises; 1000 rows of time, elevator,
/// alpha_m, q_m, az_m. The answer: the gradient of V_m at theta; of what tracks, Za Ma Mq Zd Md
/// where it ends.
bool run_filter_error(const std::string& method, const std::vector<double>& numbers, int repeats);

/// A five-hole flight (five_hole_file.hpp). The answer: the parameters, or what a method says.
bool run_five_hole(const std::string& method, const std::vector<double>& numbers, int repeats);

/// One core's operations a second at most, for SSE2, AVX2 and AVX-512 (0 where it lacks them), and
/// bytes a second that it reads, and moves in a[i] = b[i] + c d[i].
bool run_limits(const std::string& method, const std::vector<double>& numbers, int repeats);

/// Output error of a short period. numbers: 1000 rows of time, elevator, alpha_m, q_m, az_m. The
/// answer: Za Ma Mq Zd Md b_alpha b_q b_az alpha_0 q_0.
bool run_output_error(const std::string& method, const std::vector<double>& numbers, int repeats);

/// Trials of scalar example 1 (trials_file.hpp). The answer: a, c, b, trial by trial.
bool run_scalar(const std::string& method, const std::vector<double>& numbers, int repeats);

/// A smoother of four states and two outputs. numbers: x0, P0, C, R; then a sample: Phi, Q_d, y.
/// The answer: x(k|N), four numbers a sample.
bool run_smoother(const std::string& method, const std::vector<double>& numbers, int repeats);

}  // namespace benchmark
