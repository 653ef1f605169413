// SPDX-License-Identifier: BSD-3-Clause
// A calibration of every kind, fitted once to a short simulated flight that has two columns more,
// c1 and c2, for hostile names to take the place of.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fuzzing.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/simulation/simulate.hpp"

namespace sepcal::fuzz {

struct Fitted {
  Flight flight;
  Calibration calibration;
};

inline Flight with_two_columns(const SimulatedFlight& simulated) {
  Flight flight("flight");
  for (const SimulatedColumn& column : simulated.columns) flight.add(column.name, column.values);
  std::vector<double> first(simulated.rows());
  std::vector<double> second(simulated.rows());
  for (std::size_t row = 0; row < simulated.rows(); ++row) {
    const auto at = static_cast<double>(row);
    first[row] = std::sin(0.31 * at) + 0.3 * std::sin(0.013 * at * at);
    second[row] = std::cos(0.17 * at) + 0.2 * std::cos(0.021 * at * at);
  }
  flight.add("c1", std::move(first)).add("c2", std::move(second));
  return flight.label(simulated.maneuver);
}

/// Throws nothing: the flights are known, and a fit of them that fails is a finding.
inline Fitted fit_with(std::shared_ptr<const Probe> probe, Flight flight,
                       const std::vector<std::string>& effects) {
  CalibrationOptions options;
  for (const std::string& name : effects) options.effects.push_back({.name = name});
  options.fit.threads = 1;
  Calibration calibration = calibrate(std::move(probe), flight, options);
  return {std::move(flight), std::move(calibration)};
}

inline SimulationOptions short_flight() {
  SimulationOptions options;
  options.rows = 200;
  options.seed = 5;
  return options;
}

inline Flight magnetic_record() {
  return with_two_columns(simulate_magnetometer({}, short_flight()));
}
inline Flight tube_record() { return with_two_columns(simulate_pitot_static({}, short_flight())); }
inline Flight five_hole_record() {
  return with_two_columns(simulate_five_hole({}, short_flight()));
}

/// The same flight with other names for c1 and c2. Throws Error as
/// Flight::rename().
inline Flight renamed(Flight flight, std::string_view first, std::string_view second) {
  if (first != "c1") flight.rename("c1", std::string(first));
  if (second != "c2") flight.rename("c2", std::string(second));
  return flight;
}

/// A text in which `first` stands for each "c1" and `second` for each "c2".
inline std::string renamed(std::string_view text, std::string_view first, std::string_view second) {
  std::string other;
  while (!text.empty()) {
    const bool is_first = text.starts_with("c1");
    const bool is_name = is_first || text.starts_with("c2");
    other += !is_name ? text.substr(0, 1) : is_first ? first : second;
    text.remove_prefix(is_name ? 2 : 1);
  }
  return other;
}

/// The same calibration where its channels c1 and c2 are called `first` and `second`.
inline Calibration renamed(Calibration calibration, std::string_view first,
                           std::string_view second) {
  const auto rename = [&](std::string& name) {
    name = renamed(std::string_view(name), first, second);
  };
  for (EffectSetting& setting : calibration.options.effects) rename(setting.name);
  for (Parameter& parameter : calibration.fit.parameters) rename(parameter.name);
  for (HistoryEntry& entry : calibration.history) rename(entry.effect);
  std::map<std::string, Interval> ranges;
  for (const auto& [channel, range] : calibration.driver_ranges) {
    ranges.emplace(renamed(std::string_view(channel), first, second), range);
  }
  calibration.driver_ranges = std::move(ranges);
  return calibration;
}

}  // namespace sepcal::fuzz
