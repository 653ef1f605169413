// SPDX-License-Identifier: BSD-3-Clause
// A simulated flight as Python has it.
#pragma once

#include <pybind11/stl.h>

#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "sepcal/flight/flight.hpp"
#include "sepcal/simulation/simulate.hpp"

namespace sepcal::bindings {

using Hidden = std::vector<std::pair<std::string, std::vector<double>>>;  // name, sizes

/// The flight, its parameters by name, names of the hidden effects.
using Simulated = std::tuple<Flight, std::map<std::string, double>, std::vector<std::string>>;

inline Simulated simulated(SimulatedFlight made) {
  Flight flight("simulated flight");
  for (SimulatedColumn& column : made.columns) {
    flight.add(std::move(column.name), std::move(column.values));
  }
  flight.label(std::move(made.maneuver));
  return {std::move(flight), std::move(made.truth), std::move(made.effects)};
}

inline SimulationOptions simulation_options(const std::string& excitation, const std::string& noise,
                                            std::size_t decoys, double rate, std::size_t rows,
                                            std::uint64_t seed) {
  return {.rate = rate,
          .rows = rows,
          .seed = seed,
          .excitation = find_excitation(excitation),
          .noise = find_noise_kind(noise),
          .decoys = decoys};
}

/// A truth with effects at work besides.
template <class Truth>
Truth with_hidden(Truth truth, const Hidden& hidden) {
  for (const auto& [name, sizes] : hidden) truth.effects.push_back({name, sizes});
  return truth;
}

}  // namespace sepcal::bindings
