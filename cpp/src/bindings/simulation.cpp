// SPDX-License-Identifier: BSD-3-Clause
// Flights from physics. The truth crosses over as the JSON that the apps' --truth reads.
#include "sepcal/flight/simulate.hpp"

#include <pybind11/stl.h>

#include "bindings.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/truth.hpp"

namespace sepcal::bindings {
namespace {

SimulatedFlight simulate(const std::string& probe, const std::string& truth,
                         const SimulationOptions& options) {
  if (probe == "five-hole") {
    return simulate_five_hole(parse_five_hole_truth(truth, "simulate"), options);
  }
  if (probe == "magnetometer") {
    return simulate_magnetometer(parse_magnetometer_truth(truth, "simulate"), options);
  }
  throw Error("there is no probe '" + probe + "' to simulate; known: five-hole, magnetometer");
}

/// The flight and the parameters' true values.
std::pair<Flight, std::map<std::string, double>> simulate_flight(const std::string& probe,
                                                                 const std::string& truth,
                                                                 double rate, std::size_t rows,
                                                                 std::uint64_t seed) {
  SimulatedFlight simulated = simulate(probe, truth, {.rate = rate, .rows = rows, .seed = seed});
  Flight flight("simulated flight");
  for (SimulatedColumn& column : simulated.columns) {
    flight.add(std::move(column.name), std::move(column.values));
  }
  flight.label(std::move(simulated.maneuver));
  return {std::move(flight), std::move(simulated.truth)};
}

}  // namespace

void define_simulation(py::module_& module) {
  module.def("simulate", &simulate_flight, py::call_guard<py::gil_scoped_release>());
}

}  // namespace sepcal::bindings
