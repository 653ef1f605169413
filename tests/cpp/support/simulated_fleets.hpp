// SPDX-License-Identifier: BSD-3-Clause
// Flights of one five-hole probe, each in a wind of its own.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/fit_many.hpp"
#include "sepcal/models/five_hole_probe.hpp"
#include "simulated_records.hpp"

namespace sepcal::test {

inline const FiveHoleProbe fleet_probe{4.5, 4.0, {0.35, -0.1, -0.02}};
using Flights = std::vector<std::pair<std::string, Record>>;

struct FleetSimulation {
  std::vector<std::size_t> rows{180, 260, 220};
  double departure = 0.0;  // of b_alpha in the second flight
  std::uint64_t seed = 1;
};

/// Flights of a probe with lambda_va 0.08, b_va -0.7 m/s in winds that differ.
inline Flights simulate_fleet(const FleetSimulation& simulation) {
  Flights flights;
  const auto model = block_model(fleet_probe);
  for (std::size_t i = 0; i < simulation.rows.size(); ++i) {
    const auto seed = 1000 * simulation.seed + i;
    auto plain = simulate_five_hole(simulation.rows[i], 0.0, seed);
    Record record;
    for (const Variable& input : model->tables().inputs) {
      if (!plain.record.has(input.name)) continue;
      const auto column = plain.record.column(input.name);
      record.add(input.name, {column.begin(), column.end()});
    }
    Draws draws(seed + 77);
    Eigen::VectorXd xi1 = plain.xi1;
    xi1.tail(3) = 4.0 * draws.normal_matrix(3, 1);
    Eigen::VectorXd xi2 = plain.xi2;
    if (i == 1) xi2[1] += simulation.departure;
    add_outputs(record, *model, xi1, xi2, Eigen::Vector3d(0.1, 0.2, 0.3), draws);
    flights.emplace_back("flight " + std::to_string(i), std::move(record));
  }
  return flights;
}

/// All flights' rows in one record, a segment each.
inline Record stack(const Flights& flights) {
  Record stacked;
  std::vector<Segment> segments;
  std::size_t first = 0;
  for (const std::string& name : flights.front().second.names()) {
    std::vector<double> column;
    for (const auto& [label, record] : flights) {
      const auto values = record.column(name);
      column.insert(column.end(), values.begin(), values.end());
    }
    stacked.add(name, column);
  }
  for (const auto& [label, record] : flights) {
    segments.push_back({label, first, first + record.length()});
    first += record.length();
  }
  stacked.cut(segments);
  return stacked;
}

/// The same, with the flight's number in a column of its own.
inline Record stack(const Flights& flights, const std::string& number) {
  std::vector<double> numbers;
  for (std::size_t k = 0; k < flights.size(); ++k) {
    numbers.resize(numbers.size() + flights[k].second.length(), static_cast<double>(k));
  }
  Record stacked = stack(flights);
  stacked.add(number, numbers);
  return stacked;
}

inline ManyOptions wind_a_flight() {
  ManyOptions options;
  options.own = {"w_n", "w_e", "w_d"};
  options.fit.samples = 60;
  options.fit.threads = 1;
  return options;
}

}  // namespace sepcal::test
