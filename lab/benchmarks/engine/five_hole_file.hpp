// SPDX-License-Identifier: BSD-3-Clause
// A flight with a five-hole probe as lab/benchmarks/five_hole.py writes it: a header, samples
// of xi2, then columns. Parameters stand in one order throughout: lambda_va b_va w_n w_e w_d
// (linear), lambda_alpha b_alpha lambda_beta b_beta eps_phi (nonlinear); then, where two effects
// join, wind[time].n, wind[time].e and pressure_offset[throttle].s.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace benchmark {

inline constexpr int outputs = 3;    // vn, ve, vd
inline constexpr int linear = 5;     // parameters
inline constexpr int nonlinear = 5;  // parameters
inline constexpr int parameters = 10;

/// A view of `numbers`, which must outlive it.
struct FiveHoleFile {
  static constexpr std::size_t header = 26;
  enum Column { roll, pitch, yaw, p, q, r, pt, ps, dpa, dpb, rho, vn, ve, vd, time, throttle };

  explicit FiveHoleFile(const std::vector<double>& numbers)
      : rows(static_cast<std::size_t>(numbers[0])),
        samples(static_cast<std::size_t>(numbers[1])),
        k_alpha(numbers[2]),
        k_beta(numbers[3]),
        arm(numbers.data() + 4),
        noise(numbers.data() + 7),
        start(numbers.data() + 10),
        start_noise(numbers.data() + 20),
        descents(static_cast<std::size_t>(numbers[23])),
        time_centre(numbers[24]),
        throttle_centre(numbers[25]),
        points(numbers.data() + header),
        columns_(points + samples * nonlinear) {}

  const double* column(Column which) const {
    return columns_ + static_cast<std::size_t>(which) * rows;
  }

  std::size_t rows;
  std::size_t samples;
  double k_alpha;             // 1/rad
  double k_beta;              // 1/rad
  const double* arm;          // 3, m, body axes
  const double* noise;        // 3, known standard deviations, m/s
  const double* start;        // 10, where stage two starts
  const double* start_noise;  // 3, root mean square residuals there
  std::size_t descents;       // stage one descends from this many of the first samples
  double time_centre;         // s, of the effect wind[time]
  double throttle_centre;     // of pressure_offset[throttle]
  const double* points;       // samples x 5, the samples of xi2

 private:
  const double* columns_;
};

}  // namespace benchmark
