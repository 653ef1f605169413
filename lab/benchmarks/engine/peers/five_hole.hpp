// SPDX-License-Identifier: BSD-3-Clause
// What Ceres and Eigen do on a five-hole flight.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "five_hole_file.hpp"
#include "peers/hoisted.hpp"
#include "program.hpp"

namespace ceres {
class Problem;
}

namespace benchmark {

/// How Ceres is given the flight, and by what it solves.
struct CeresWay {
  int samples;    // a residual block
  bool analytic;  // derivatives by hand instead of automatic ones
  bool qr;        // DENSE_QR instead of DENSE_NORMAL_CHOLESKY
};

/// From x (10) on: the least squares of residuals over `noise` (3). Returns the cost.
double solve_by_ceres(const std::vector<HoistedRow>& rows, const CeresWay& way, const double* noise,
                      Answer& x);

/// What a problem is solved with throughout. Returns the cost.
double solve(ceres::Problem& problem, bool qr);

/// Solves again and again, `noise` (3) and x in turn, until no variance changes by more than a
/// thousandth; noise_at() is that of x.
void alternate(ceres::Problem& problem, bool qr, std::array<double, 3>& noise,
               const std::function<std::array<double, 3>()>& noise_at);

/// The same with R and the parameters in turn (Eqs. 24-26), until no variance changes by more than
/// a thousandth; `noise` is that of x at first.
void alternate_by_ceres(const std::vector<HoistedRow>& rows, const CeresWay& way,
                        std::array<double, 3> noise, Answer& x);

/// Root mean square residuals at x (10).
std::array<double, 3> noise_at(const std::vector<HoistedRow>& rows, const Answer& x);

/// Stage one's samples by ColPivHouseholderQR; with the columns of a wind that drifts, `drift` by
/// row, whose two coefficients then follow in every x.
struct Sampled {
  std::vector<Answer> starts;  // (xi1, xi2) of the first samples, from which to descend
  Answer best;                 // 10
};
Sampled sample_by_eigen(const std::vector<HoistedRow>& rows, const FiveHoleFile& file,
                        const std::vector<double>& drift = {});

/// Both stages with two effects, a wind that drifts and an offset of the pressure (13).
Answer fit_with_effects(const FiveHoleFile& file);

}  // namespace benchmark
