// SPDX-License-Identifier: BSD-3-Clause
// Output error of a short period by Ceres' automatic derivatives through one Runge-Kutta
// integration, as a user of Ceres would write it.
#include <ceres/ceres.h>

#include <array>

#include "peers/peers.hpp"

namespace benchmark {
namespace {

constexpr int rows = 1000;
constexpr double airspeed = 25.0;               // m/s
constexpr std::array noise{0.005, 0.01, 0.15};  // rad, rad/s, m/s^2
constexpr std::array start{-3.0, -30.0, -4.0, -0.3, -35.0, 0.0, 0.0, 0.0, 0.0, 0.0};

/// All residuals of the record.
struct Residuals {
  const double* time;
  const double* elevator;
  const double* read;  // alpha, q, az, one after another

  template <class T>
  bool operator()(const T* p, T* residual) const {
    T alpha = p[8];
    T q = p[9];
    for (int k = 0; k < rows; ++k) {
      const double u = elevator[k];
      residual[3 * k] = (read[k] - alpha - p[5]) / noise[0];
      residual[3 * k + 1] = (read[rows + k] - q - p[6]) / noise[1];
      residual[3 * k + 2] =
          (read[2 * rows + k] - airspeed * (p[0] * alpha + p[3] * u) - p[7]) / noise[2];
      if (k + 1 < rows) step(p, u, elevator[k + 1], time[k + 1] - time[k], alpha, q);
    }
    return true;
  }

  template <class T>
  static void step(const T* p, double u_0, double u_1, double dt, T& alpha, T& q) {
    const double half = 0.5 * (u_0 + u_1);
    const auto rate = [p](const T& a, const T& r, double u, T& da, T& dq) {
      da = p[0] * a + r + p[3] * u;
      dq = p[1] * a + p[2] * r + p[4] * u;
    };
    T a1, a2, a3, a4, q1, q2, q3, q4;
    rate(alpha, q, u_0, a1, q1);
    rate(alpha + 0.5 * dt * a1, q + 0.5 * dt * q1, half, a2, q2);
    rate(alpha + 0.5 * dt * a2, q + 0.5 * dt * q2, half, a3, q3);
    rate(alpha + dt * a3, q + dt * q3, u_1, a4, q4);
    alpha += dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    q += dt / 6.0 * (q1 + 2.0 * q2 + 2.0 * q3 + q4);
  }
};

Answer by_ceres(const std::vector<double>& numbers) {
  Answer p(start.begin(), start.end());
  ceres::Problem problem;
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Residuals, 3 * rows, 10>(new Residuals{
                               numbers.data(), numbers.data() + rows, numbers.data() + 2 * rows}),
                           nullptr, p.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.function_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return p;
}

}  // namespace

bool run_output_error_peers(const std::string& method, const std::vector<double>& numbers,
                            int repeats) {
  if (method != "ceres") return false;
  report(repeats, [&] { return by_ceres(numbers); });
  return true;
}

}  // namespace benchmark
