// SPDX-License-Identifier: BSD-3-Clause
// What tells one app from the other: the probe's own options, how a probe is made of them, and what
// a simulated flight is. Everything else is the same code.
#pragma once

#include <CLI/App.hpp>
#include <memory>
#include <string>
#include <vector>

#include "sepcal/detail/simulation/truth.hpp"
#include "sepcal/flight/flight.hpp"
#include "sepcal/flight/probe.hpp"
#include "sepcal/simulation/simulate.hpp"

namespace sepcal::app {

/// What to simulate.
struct SimulationOrder {
  std::string truth;                // JSON, or empty for the defaults
  std::string source;               // opens messages about the truth
  std::vector<SizedEffect> hidden;  // beside those of the truth
  SimulationOptions options;
};

/// A simulated flight and the truth behind it, as JSON.
struct Simulation {
  SimulatedFlight flight;
  std::string truth;
};

/// Flies `truth` with the order's hidden effects.
template <class Truth>
Simulation fly(Truth truth, SimulatedFlight (*simulate)(const Truth&, const SimulationOptions&),
               const SimulationOrder& order) {
  truth.effects.insert(truth.effects.end(), order.hidden.begin(), order.hidden.end());
  SimulatedFlight flight = simulate(truth, order.options);
  std::string json = to_json(as_flown(std::move(truth), flight));
  return {std::move(flight), std::move(json)};
}

class Instrument {
 public:
  Instrument() = default;
  Instrument(const Instrument&) = delete;
  Instrument& operator=(const Instrument&) = delete;
  virtual ~Instrument() = default;

  virtual std::string app() const = 0;                  // "sepcal-pitot"
  virtual std::string summary() const = 0;              // one line for --help
  virtual std::vector<std::string> models() const = 0;  // "five-hole", ...

  /// Adds the probe's options to `fit`; they fill members of the instrument.
  virtual void add_probe_options(CLI::App& fit) = 0;

  /// The probe that the options and the flight's columns ask for. Throws Error where an option is
  /// missing or makes no sense.
  virtual std::shared_ptr<const Probe> probe(const Flight& flight) const = 0;

  /// Adds what another flight than the fitted one may need to a verb that takes a calibration.
  virtual void add_flight_options(CLI::App& /*verb*/) {}

  /// The calibration's probe with these options. Throws Error where they make no sense for it.
  virtual std::shared_ptr<const Probe> probe_for_flight(std::shared_ptr<const Probe> fitted) const {
    return fitted;
  }

  /// Adds the probe's options to `simulate`; they fill members of the instrument.
  virtual void add_simulation_options(CLI::App& simulate) = 0;

  virtual Simulation simulate(const SimulationOrder& order) const = 0;
};

/// Runs the app: parses the command line, carries out the verb, maps every error to one line on
/// standard error. Returns the exit code (0, 2, 4 or 5). `called` is what was typed to get here:
/// "sepcal-mag", or "sepcal mag".
int run(Instrument& instrument, const std::string& called, int argc, char** argv);

/// What can be typed after that, as tables.hpp has it.
std::string table_of(Instrument& instrument, const std::string& called);

}  // namespace sepcal::app
