// SPDX-License-Identifier: BSD-3-Clause
// Flights of a short period, exact: the state from row to row by the matrix exponential, with an
// elevator that is a line between rows.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>
#include <vector>

#include "sepcal/record.hpp"
#include "simulated_records.hpp"

namespace sepcal::test {

struct ShortPeriodFlight {
  Eigen::Matrix2d F = (Eigen::Matrix2d() << -4, 1, -40, -5).finished();
  Eigen::Vector2d B = {-0.35, -45};
  double airspeed = 25.0;  // m/s
  Eigen::Vector2d start = {0.01, -0.05};
  Eigen::Vector3d bias = {0.02, -0.01, 0.5};
  Eigen::Vector3d noise = {0.005, 0.01, 0.15};  // rad, rad/s, m/s^2
  double quantum = 0.0;                         // of alpha, rad
  Eigen::Vector2d feedback = {0, 0};            // elevator beside the excitation, of alpha and q
  Eigen::Vector2d process_noise = {0, 0};       // of alpha', q', rad/sqrt(s), rad/s/sqrt(s)
  std::size_t rows = 1000;
  double interval = 0.02;  // s
  std::uint64_t seed = 1;
};

/// 3-2-1-1 of 0.06 rad both ways, then a sweep of 0.04 rad up to 3 Hz.
inline double excitation(double t) {
  for (const double begin : {1.0, 6.0}) {
    const double at = (t - begin) / 0.3;
    if (at < 0 || at >= 7) continue;
    const double sign = begin < 2 ? 0.06 : -0.06;
    return at < 3 ? sign : at < 5 ? -sign : at < 6 ? sign : -sign;
  }
  if (t < 10) return 0.0;
  return 0.04 * std::sin(2.0 * 3.14159265 * (0.1 * (t - 10) + 0.145 * (t - 10) * (t - 10)));
}

inline Record fly_short_period(const ShortPeriodFlight& flight) {
  // z = [x; u; du] : x' = F x + B u, u' = du / dt; noise enters ten times a row, in the middle of a
  // part.
  const bool stirred = !flight.process_noise.isZero();
  const int parts = stirred ? 10 : 1;
  const double dt = flight.interval / parts;
  Eigen::Matrix4d block = Eigen::Matrix4d::Zero();
  block.topLeftCorner<2, 2>() = flight.F * dt;
  block.block<2, 1>(0, 2) = flight.B * dt;
  block(2, 3) = 1.0;
  const Eigen::Matrix4d half = (0.5 * block).exp();
  Draws draws(flight.seed);
  std::vector<double> time;
  std::vector<double> elevator;
  std::vector<double> alpha;
  std::vector<double> q;
  std::vector<double> az;
  Eigen::Vector2d x = flight.start;
  double u = 0.0;
  for (std::size_t k = 0; k < flight.rows; ++k) {
    const double t = flight.interval * static_cast<double>(k);
    const Eigen::Vector3d v = flight.noise.cwiseProduct(draws.normal_matrix(3, 1));
    time.push_back(t);
    elevator.push_back(u);
    const double read = x[0] + flight.bias[0] + v[0];
    alpha.push_back(flight.quantum > 0 ? flight.quantum * std::round(read / flight.quantum) : read);
    q.push_back(x[1] + flight.bias[1] + v[1]);
    az.push_back(flight.airspeed * (flight.F(0, 0) * x[0] + flight.B[0] * u) + flight.bias[2] +
                 v[2]);
    const double next = excitation(t + flight.interval) + flight.feedback.dot(x);
    Eigen::Vector4d whole(x[0], x[1], u, (next - u) / parts);
    for (int part = 0; part < parts; ++part) {
      whole = half * whole;
      if (stirred) {
        const Eigen::Vector2d w = draws.normal_matrix(2, 1);
        whole.head<2>() += std::sqrt(dt) * flight.process_noise.cwiseProduct(w);
      }
      whole = half * whole;
    }
    x = whole.head<2>();
    u = next;
  }
  Record record;
  record.add("time", time).add("elevator", elevator);
  record.add("airspeed", std::vector<double>(flight.rows, flight.airspeed));
  record.add("alpha_m", alpha).add("q_m", q).add("az_m", az);
  return record;
}

}  // namespace sepcal::test
