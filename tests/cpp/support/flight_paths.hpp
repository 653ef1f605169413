// SPDX-License-Identifier: BSD-3-Clause
// A flight whose motion is written down, not integrated: u v w and the attitude are sums of waves,
// and what the inertial unit reads follows from their derivatives in closed form.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "sepcal/record.hpp"
#include "simulated_records.hpp"

namespace sepcal::test {

/// offset + slope t + sum of amplitude sin(frequency t + phase).
struct Waves {
  double offset = 0.0;
  double slope = 0.0;
  std::vector<std::array<double, 3>> parts = {};

  double value(double t) const {
    double sum = offset + slope * t;
    for (const auto& [a, w, c] : parts) sum += a * std::sin(w * t + c);
    return sum;
  }
  double rate(double t) const {
    double sum = slope;
    for (const auto& [a, w, c] : parts) sum += a * w * std::cos(w * t + c);
    return sum;
  }
};

struct WrittenFlight {
  std::array<Waves, 3> velocity = {Waves{50, 0.1, {{4, 0.5, 0.3}, {1, 1.9, 1.0}}},
                                   Waves{0.5, 0, {{2, 0.8, 0.1}, {1, 2.7, 2.0}}},
                                   Waves{3, 0, {{2, 1.1, 0.7}, {1, 3.1, 0.2}}}};
  std::array<Waves, 3> attitude = {Waves{0.05, 0, {{0.5, 0.6, 0.2}, {0.2, 2.1, 1.1}}},
                                   Waves{0.06, 0, {{0.15, 0.9, 0.4}, {0.06, 2.3, 0.8}}},
                                   Waves{0.4, 0.03, {{0.3, 0.4, 0.6}, {0.05, 1.7, 0.1}}}};
  double gravity = 9.80665;
  Eigen::Vector3d wind = {3.0, -2.0, 0.3};
};

/// Columns of FlightPath, 1 / interval a second, for so many rows. IMU logged = true - b, outputs
/// logged = (1 + lambda) true + b, by the names in `errors`; noise in units of 0.2 m/s and 0.002
/// rad, drawn for the outputs.
inline Record write_flight(const WrittenFlight& flight, std::size_t rows, double interval,
                           const std::map<std::string, double>& errors, double noise,
                           std::uint64_t seed = 5) {
  const auto error = [&](const std::string& name) {
    const auto at = errors.find(name);
    return at == errors.end() ? 0.0 : at->second;
  };
  Draws draws(seed);
  std::map<std::string, std::vector<double>> columns;
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = interval * static_cast<double>(k);
    Eigen::Vector3d v;
    Eigen::Vector3d dv;
    Eigen::Vector3d e;
    Eigen::Vector3d de;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      v[at] = flight.velocity[i].value(t);
      dv[at] = flight.velocity[i].rate(t);
      e[at] = flight.attitude[i].value(t);
      de[at] = flight.attitude[i].rate(t);
    }
    const Eigen::Vector3d turn(de[0] - de[2] * std::sin(e[1]),
                               de[1] * std::cos(e[0]) + de[2] * std::cos(e[1]) * std::sin(e[0]),
                               -de[1] * std::sin(e[0]) + de[2] * std::cos(e[1]) * std::cos(e[0]));
    const Eigen::Matrix3d to_ned = (Eigen::AngleAxisd(e[2], Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(e[1], Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(e[0], Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
    const Eigen::Vector3d force =
        dv + turn.cross(v) - to_ned.transpose() * Eigen::Vector3d(0, 0, flight.gravity);
    const Eigen::Vector3d ground = to_ned * v + flight.wind;
    const auto log = [&](const std::string& name, double value) { columns[name].push_back(value); };
    const auto read = [&](const std::string& name, const std::string& of, double value,
                          double deviation) {
      log(name, (1.0 + error("lambda_" + of)) * value + error("b_" + of) +
                    noise * deviation * draws.normal());
    };
    log("time", t);
    for (const int i : {0, 1, 2}) {
      const std::string force_name = std::array{"ax", "ay", "az"}[static_cast<std::size_t>(i)];
      const std::string turn_name = std::array{"p", "q", "r"}[static_cast<std::size_t>(i)];
      log(force_name, force[i] - error("b_" + force_name));
      log(turn_name, turn[i] - error("b_" + turn_name));
    }
    read("airspeed", "v", v.norm(), 0.2);
    read("beta", "beta", std::asin(v[1] / v.norm()), 0.002);
    read("alpha", "alpha", std::atan2(v[2], v[0]), 0.002);
    read("roll", "phi", e[0], 0.002);
    read("pitch", "theta", e[1], 0.002);
    read("yaw", "psi", e[2], 0.002);
    for (const int i : {0, 1, 2}) {
      read(std::array{"vn", "ve", "vd"}[static_cast<std::size_t>(i)], "ground", ground[i], 0.2);
    }
  }
  Record record;
  for (auto& [name, values] : columns) record.add(name, std::move(values));
  return record;
}

}  // namespace sepcal::test
