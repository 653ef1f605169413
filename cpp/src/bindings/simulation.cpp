// SPDX-License-Identifier: BSD-3-Clause
// Flights from physics. The truth crosses over as the JSON that the apps' --truth reads.
#include "sepcal/simulation/simulate.hpp"

#include "bindings.hpp"
#include "released.hpp"
#include "sepcal/error.hpp"
#include "sepcal/simulation/truth.hpp"
#include "simulated.hpp"

namespace sepcal::bindings {
namespace {

SimulatedFlight simulate(const std::string& probe, const std::string& truth, const Hidden& hidden,
                         const SimulationOptions& options) {
  const char* source = "simulate";
  if (probe == "five-hole") {
    return simulate_five_hole(with_hidden(parse_five_hole_truth(truth, source), hidden), options);
  }
  if (probe == "pitot-static") {
    return simulate_pitot_static(with_hidden(parse_pitot_static_truth(truth, source), hidden),
                                 options);
  }
  if (probe == "magnetometer" || probe == "magnetometer-norm") {
    return simulate_magnetometer(with_hidden(parse_magnetometer_truth(truth, source), hidden),
                                 options);
  }
  throw Error("there is no probe '" + probe +
              "' to simulate; known: five-hole, pitot-static, magnetometer, magnetometer-norm");
}

}  // namespace

void define_simulation(py::module_& module) {
  module.def(
      "simulate", [](const std::string& probe, const std::string& truth, const Hidden& hidden,
                     const std::string& excitation, const std::string& noise, std::size_t decoys,
                     double rate, std::size_t rows, std::uint64_t seed) {
        const Released released;
        return simulated(simulate(probe, truth, hidden,
                                  simulation_options(excitation, noise, decoys, rate, rows, seed)));
      });
}

}  // namespace sepcal::bindings
