// SPDX-License-Identifier: BSD-3-Clause
// Logs written down by formula, clean until a test spoils them, and what a check says of them.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "flight_log.hpp"
#include "sepcal/flight/check.hpp"

namespace sepcal::test {

using std::numbers::pi;

/// Adds white noise.
inline void blur(std::vector<double>& values, double sd, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0.0, sd);
  for (double& value : values) value += normal(engine);
}

/// A tube that flies three full turns at 14 to 26 m/s in a wind of (4, -3) m/s, 50 Hz.
inline Log tube_log(std::size_t rows = 3000, std::uint64_t seed = 1) {
  Log log;
  for (const char* header : {"time_s", "vn_mps", "ve_mps", "vd_mps", "airspeed_mps", "yaw_rad",
                             "pitch_rad", "roll_rad"}) {
    log.columns.emplace_back(header, std::vector<double>(rows));
  }
  for (std::size_t row = 0; row < rows; ++row) {
    const double share = static_cast<double>(row) / static_cast<double>(rows);
    const double speed = 20 + 6 * std::sin(2 * pi * 5 * share);
    const double yaw = 2 * pi * 3 * share;
    log["time_s"][row] = 0.02 * static_cast<double>(row);
    log["vn_mps"][row] = speed * std::cos(yaw) + 4;
    log["ve_mps"][row] = speed * std::sin(yaw) - 3;
    log["vd_mps"][row] = std::sin(2 * pi * 7 * share);
    log["airspeed_mps"][row] = speed;
    log["yaw_rad"][row] = std::remainder(yaw, 2 * pi);
    log["pitch_rad"][row] = 0.1 * std::sin(2 * pi * 7 * share);
    log["roll_rad"][row] = 0.4 + 0.1 * std::sin(2 * pi * 2 * share);
  }
  double sd = 0.1;
  for (auto& [header, values] : log.columns) {
    if (header == "time_s") continue;
    if (header == "yaw_rad") sd = 0.005;  // the angles come last
    blur(values, sd, ++seed);
  }
  return log;
}

inline FlightCheck check_tube(const Log& log) { return check(*pitot_static_probe(), log.build()); }

/// A magnetometer turned all round: Fibonacci's lattice of directions of the true field of 50 uT, a
/// hard iron of (10, -20, 5) uT. The true field is logged.
inline Log sphere_log(std::size_t rows = 1500, std::uint64_t seed = 1) {
  Log log;
  for (const char* header : {"time_s", "mx_ut", "my_ut", "mz_ut", "hx_ut", "hy_ut", "hz_ut"}) {
    log.columns.emplace_back(header, std::vector<double>(rows));
  }
  for (std::size_t row = 0; row < rows; ++row) {
    const double z = 1 - (2 * static_cast<double>(row) + 1) / static_cast<double>(rows);
    const double turn = 0.05 * static_cast<double>(row);  // a spiral from pole to pole
    const double r = std::sqrt(1 - z * z);
    log["time_s"][row] = 0.02 * static_cast<double>(row);
    log["hx_ut"][row] = 50 * r * std::cos(turn);
    log["hy_ut"][row] = 50 * r * std::sin(turn);
    log["hz_ut"][row] = 50 * z;
    log["mx_ut"][row] = log["hx_ut"][row] + 10;
    log["my_ut"][row] = log["hy_ut"][row] - 20;
    log["mz_ut"][row] = log["hz_ut"][row] + 5;
  }
  for (const char* header : {"mx_ut", "my_ut", "mz_ut"}) blur(log[header], 0.2, ++seed);
  return log;
}

inline FlightCheck check_sphere(const Log& log) {
  return check(*magnetometer_probe(std::nullopt), log.build());
}

/// The notes of that kind.
inline std::vector<LogNote> notes_of(const FlightCheck& checked, const std::string& kind) {
  std::vector<LogNote> notes;
  std::ranges::copy_if(checked.notes, std::back_inserter(notes),
                       [&](const LogNote& note) { return note.kind == kind; });
  return notes;
}

/// The kinds of all notes, worst first: "units, held".
inline std::string kinds(const FlightCheck& checked) {
  std::string list;
  for (const LogNote& note : checked.notes) list += (list.empty() ? "" : ", ") + note.kind;
  return list;
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace sepcal::test
