// SPDX-License-Identifier: BSD-3-Clause
// Flights from physics. The truth crosses over as the JSON that the apps' --truth reads.
#include "sepcal/simulation/simulate.hpp"

#include <pybind11/stl.h>

#include "bindings.hpp"
#include "sepcal/error.hpp"
#include "sepcal/simulation/truth.hpp"

namespace sepcal::bindings {
namespace {

using Hidden = std::vector<std::pair<std::string, std::vector<double>>>;  // name, sizes

SimulatedFlight simulate(const std::string& probe, const std::string& truth, const Hidden& hidden,
                         const SimulationOptions& options) {
  const auto with_hidden = [&](auto parsed) {
    for (const auto& [name, sizes] : hidden) parsed.effects.push_back({name, sizes});
    return parsed;
  };
  const char* source = "simulate";
  if (probe == "five-hole") {
    return simulate_five_hole(with_hidden(parse_five_hole_truth(truth, source)), options);
  }
  if (probe == "pitot-static") {
    return simulate_pitot_static(with_hidden(parse_pitot_static_truth(truth, source)), options);
  }
  if (probe == "magnetometer" || probe == "magnetometer-norm") {
    return simulate_magnetometer(with_hidden(parse_magnetometer_truth(truth, source)), options);
  }
  throw Error("there is no probe '" + probe +
              "' to simulate; known: five-hole, pitot-static, magnetometer, magnetometer-norm");
}

struct Simulated {
  Flight flight;
  std::map<std::string, double> truth;  // parameters by name
  std::vector<std::string> effects;     // names of the hidden ones
};

Simulated simulate_flight(const std::string& probe, const std::string& truth, const Hidden& hidden,
                          const SimulationOptions& options) {
  SimulatedFlight simulated = simulate(probe, truth, hidden, options);
  Flight flight("simulated flight");
  for (SimulatedColumn& column : simulated.columns) {
    flight.add(std::move(column.name), std::move(column.values));
  }
  flight.label(std::move(simulated.maneuver));
  return {std::move(flight), std::move(simulated.truth), std::move(simulated.effects)};
}

}  // namespace

void define_simulation(py::module_& module) {
  module.def(
      "simulate", [](const std::string& probe, const std::string& truth, const Hidden& hidden,
                     const std::string& excitation, const std::string& noise, std::size_t decoys,
                     double rate, std::size_t rows, std::uint64_t seed) {
        Simulated simulated;
        {
          const py::gil_scoped_release released;
          simulated = simulate_flight(probe, truth, hidden,
                                      {.rate = rate,
                                       .rows = rows,
                                       .seed = seed,
                                       .excitation = find_excitation(excitation),
                                       .noise = find_noise_kind(noise),
                                       .decoys = decoys});
        }
        return py::make_tuple(std::move(simulated.flight), simulated.truth, simulated.effects);
      });
}

}  // namespace sepcal::bindings
