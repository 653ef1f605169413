// SPDX-License-Identifier: BSD-3-Clause
// What the parts of the peers' program share.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "clock.hpp"
#include "five_hole_file.hpp"
#include "peers/hoisted.hpp"

namespace benchmark {

/// How Ceres is given the flight, and by what it solves.
struct CeresWay {
  int samples;    // a residual block
  bool analytic;  // derivatives by hand instead of automatic ones
  bool qr;        // DENSE_QR instead of DENSE_NORMAL_CHOLESKY
};

/// From x (10) on: the least squares of residuals over `noise` (3).
void solve_by_ceres(const std::vector<HoistedRow>& rows, const CeresWay& way, const double* noise,
                    Answer& x);

/// The same with R and the parameters in turn (Eqs. 24-26), until no variance changes by more than
/// a thousandth; `noise` is that of x at first.
void alternate_by_ceres(const std::vector<HoistedRow>& rows, const CeresWay& way,
                        std::array<double, 3> noise, Answer& x);

/// Root mean square residuals at x (10).
std::array<double, 3> noise_at(const std::vector<HoistedRow>& rows, const Answer& x);

/// Stage one's samples by ColPivHouseholderQR.
struct Sampled {
  std::vector<double> squares;  // a sample: the sum of squares with the best xi1
  Answer best;                  // 10
};
Sampled sample_by_eigen(const std::vector<HoistedRow>& rows, const FiveHoleFile& file);

/// xi1 (5) by linear least squares at xi2 (5).
std::array<double, 5> linear_estimate(const std::vector<HoistedRow>& rows, const double* xi2);

}  // namespace benchmark
