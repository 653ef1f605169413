// SPDX-License-Identifier: BSD-3-Clause
// The problems of the peers' programs.
#pragma once

#include <string>
#include <vector>

#include "program.hpp"

namespace benchmark {

/// A five-hole flight (five_hole_file.hpp), by METHOD:WAY; the answer, its ten parameters. Methods:
/// sampling, stage-one, stage-two, known-noise, fit. WAY: "50-by-hand-qr" is 50 samples a residual
/// block, derivatives by hand instead of automatic ones, DENSE_QR instead of DENSE_NORMAL_CHOLESKY.
bool run_five_hole_peers(const std::string& method, const std::vector<double>& numbers,
                         int repeats);

/// Output error of a short period by ceres; numbers and answer as in benchmark.hpp.
bool run_output_error_peers(const std::string& method, const std::vector<double>& numbers,
                            int repeats);

/// Trials of scalar example 1 (trials_file.hpp), by ceres or tiny-solver; the answer: a, c, b.
bool run_scalar_peers(const std::string& method, const std::vector<double>& numbers, int repeats);

}  // namespace benchmark
