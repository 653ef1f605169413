// SPDX-License-Identifier: BSD-3-Clause
// Flights from physics. The truth crosses over as the JSON that the apps' --truth reads.
#include "sepcal/simulation/simulate.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "bindings.hpp"
#include "released.hpp"
#include "sepcal/detail/simulation/truth.hpp"
#include "sepcal/error.hpp"
#include "simulated.hpp"

namespace sepcal::bindings {
namespace {

template <auto parse, auto fly>
SimulatedFlight simulate_from(const std::string& truth, const Hidden& hidden,
                              const SimulationOptions& options) {
  return fly(with_hidden(parse(truth, "simulate"), hidden), options);
}

struct Simulator {
  std::string_view probe;
  SimulatedFlight (*simulate)(const std::string& truth, const Hidden& hidden,
                              const SimulationOptions& options);
};

constexpr auto simulate_field = &simulate_from<parse_magnetometer_truth, simulate_magnetometer>;
constexpr std::array simulators{
    Simulator{"five-hole", &simulate_from<parse_five_hole_truth, simulate_five_hole>},
    Simulator{"pitot-static", &simulate_from<parse_pitot_static_truth, simulate_pitot_static>},
    Simulator{"magnetometer", simulate_field},
    Simulator{"magnetometer-norm", simulate_field},
};

SimulatedFlight simulate(const std::string& probe, const std::string& truth, const Hidden& hidden,
                         const SimulationOptions& options) {
  const auto* const one = std::ranges::find(simulators, probe, &Simulator::probe);
  if (one != simulators.end()) return one->simulate(truth, hidden, options);
  std::string known;
  for (const Simulator& each : simulators)
    known += (known.empty() ? "" : ", ") + std::string(each.probe);
  throw Error("there is no probe '" + probe + "' to simulate; known: " + known);
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
