// SPDX-License-Identifier: BSD-3-Clause
// The five-hole probe with two effects: a wind that drifts with time, linear in its parameters, and
// a pressure that is off with the throttle, which makes the airspeed as read depend on a parameter.
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>

#include "peers/five_hole.hpp"

namespace benchmark {
namespace {

constexpr int with_effects = 13;
constexpr std::size_t block = 50;  // rows

struct Flight {
  std::vector<HoistedRow> rows;
  std::vector<double> drift;     // time about its centre
  std::vector<double> throttle;  // about its centre
  std::vector<double> pressure;  // pt - ps
  std::vector<double> by_rho;    // 2 / rho

  explicit Flight(const FiveHoleFile& file) : rows(hoist(file)) {
    using F = FiveHoleFile;
    for (std::size_t i = 0; i < file.rows; ++i) {
      drift.push_back(file.column(F::time)[i] - file.time_centre);
      throttle.push_back(file.column(F::throttle)[i] - file.throttle_centre);
      pressure.push_back(file.column(F::pt)[i] - file.column(F::ps)[i]);
      by_rho.push_back(2.0 / file.column(F::rho)[i]);
    }
  }
};

/// Of `count` rows from `first` on; x: the ten parameters, the drift north and east, the offset.
struct Residuals {
  const Flight& flight;
  std::size_t first;
  std::size_t count;
  const double* noise;

  template <class T>
  bool operator()(const T* x, T* residual) const {
    using std::cos;
    using std::sin;
    using std::sqrt;
    const T cos_eps = cos(x[9]);
    const T sin_eps = sin(x[9]);
    for (std::size_t i = first; i < first + count; ++i) {
      const HoistedRow& row = flight.rows[i];
      T F[3];
      air_direction(row, x + 5, cos_eps, sin_eps, F);
      const T read = sqrt((flight.pressure[i] + x[12] * flight.throttle[i]) * flight.by_rho[i]);
      const T V = (1.0 + x[0]) * read + x[1];
      for (int j = 0; j < 3; ++j) {
        T modelled = F[j] * V - row.rotation[j] + x[2 + j];
        if (j < 2) modelled += x[10 + j] * flight.drift[i];
        *residual++ = (row.z[j] - modelled) / noise[j];
      }
    }
    return true;
  }
};

std::array<double, 3> noise_of(const Flight& flight, const Answer& x) {
  const double one[3] = {1.0, 1.0, 1.0};
  const std::size_t N = flight.rows.size();
  std::vector<double> residuals(3 * N);
  Residuals{flight, 0, N, one}(x.data(), residuals.data());
  std::array<double, 3> squares{};
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    squares[k % 3] += residuals[k] * residuals[k];
  }
  for (double& square : squares) square = std::sqrt(square / static_cast<double>(N));
  return squares;
}

}  // namespace

Answer fit_with_effects(const FiveHoleFile& file) {
  const Flight flight(file);
  Answer x = sample_by_eigen(flight.rows, file, flight.drift).best;
  x.push_back(0.0);  // the offset
  std::array<double, 3> noise = noise_of(flight, x);
  ceres::Problem problem;
  using Cost = ceres::AutoDiffCostFunction<Residuals, ceres::DYNAMIC, with_effects>;
  for (std::size_t i = 0; i < file.rows; i += block) {
    const std::size_t count = std::min(block, file.rows - i);
    problem.AddResidualBlock(
        new Cost(new Residuals{flight, i, count, noise.data()}, static_cast<int>(3 * count)),
        nullptr, x.data());
  }
  alternate(problem, false, noise, [&] { return noise_of(flight, x); });
  return x;
}

}  // namespace benchmark
