// SPDX-License-Identifier: BSD-3-Clause
// Two short logs in which every effect finds its channels: smooth closed forms of time, no sensor
// behind them. What is fuzzed here is reading, and no estimate is made of them.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/flight/flight.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal::fuzz {

inline constexpr std::size_t flight_rows = 48;

/// Adds mean + swing sin(rate t), t = 0, 0.1, 0.2 ... s.
inline void add_wave(Flight& flight, const char* header, double mean, double swing, double rate) {
  std::vector<double> values(flight_rows);
  for (std::size_t row = 0; row < flight_rows; ++row) {
    values[row] = mean + swing * std::sin(rate * 0.1 * static_cast<double>(row));
  }
  flight.add(header, std::move(values));
}

inline Flight begin_flight(const char* name) {
  Flight flight(name);
  std::vector<double> time(flight_rows);
  std::vector<std::string> labels(flight_rows);
  for (std::size_t row = 0; row < flight_rows; ++row) {
    time[row] = 0.1 * static_cast<double>(row);
    labels[row] = row < flight_rows / 2 ? "turn" : "climb";
  }
  flight.add("time_s", std::move(time)).label(std::move(labels));
  for (const auto& [header, rate] :
       {std::pair{"roll_rad", 0.7}, std::pair{"pitch_rad", 0.9}, std::pair{"yaw_rad", 1.1},
        std::pair{"p_radps", 1.3}, std::pair{"q_radps", 1.5}, std::pair{"r_radps", 1.7}}) {
    add_wave(flight, header, 0.02, 0.4, rate);
  }
  add_wave(flight, "throttle", 0.5, 0.3, 1.9);
  add_wave(flight, "current_a", 8.0, 5.0, 2.1);
  return flight;
}

inline Flight air_flight() {
  Flight flight = begin_flight("air");
  add_wave(flight, "vn_mps", 2.0, 18.0, 0.8);
  add_wave(flight, "ve_mps", -1.0, 17.0, 1.2);
  add_wave(flight, "vd_mps", 0.1, 1.0, 1.6);
  add_wave(flight, "pt_pa", 98'500.0, 60.0, 1.4);
  add_wave(flight, "ps_pa", 98'200.0, 20.0, 0.6);
  add_wave(flight, "dpa_pa", 10.0, 50.0, 2.3);
  add_wave(flight, "dpb_pa", -5.0, 50.0, 2.5);
  add_wave(flight, "dp_pa", 300.0, 60.0, 1.4);
  add_wave(flight, "airspeed_mps", 21.0, 3.0, 1.4);
  add_wave(flight, "rho_kgpm3", 1.19, 0.01, 0.6);
  add_wave(flight, "temp_k", 286.0, 1.0, 0.6);
  add_wave(flight, "altitude_m", 300.0, 40.0, 0.6);
  return flight;
}

inline Flight magnetic_flight() {
  Flight flight = begin_flight("magnetic");
  for (const auto& [header, rate] :
       {std::pair{"mx_ut", 0.8}, std::pair{"my_ut", 1.2}, std::pair{"mz_ut", 1.6}}) {
    add_wave(flight, header, 8.0, 45.0, rate);
  }
  add_wave(flight, "bn_ut", 19.7, 0.1, 0.3);
  add_wave(flight, "be_ut", -1.4, 0.1, 0.3);
  add_wave(flight, "bd_ut", 49.4, 0.1, 0.3);
  add_wave(flight, "temp_degc", 25.0, 6.0, 0.6);
  return flight;
}

/// A probe of every kind.
inline const std::vector<std::shared_ptr<const Probe>>& probes() {
  static const std::vector<std::shared_ptr<const Probe>> all{
      five_hole_probe(4.5, 4.5, {0.35, 0.0, -0.02}),
      pitot_static_probe(),
      magnetometer_probe(std::nullopt),
      magnetometer_probe(std::array{19.7, -1.4, 49.4}),
      attitude_independent_probe(53.2),
  };
  return all;
}

/// The log that a probe of that kind can read.
inline const Flight& flight_for(const Probe& probe) {
  static const Flight air = air_flight();
  static const Flight magnetic = magnetic_flight();
  return probe.app() == "sepcal-pitot" ? air : magnetic;
}

}  // namespace sepcal::fuzz
