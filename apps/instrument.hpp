// SPDX-License-Identifier: BSD-3-Clause
// What tells one app from the other: the probe's own options, how a probe is made of them, and what
// a simulated flight is. Everything else is the same code.
#pragma once

#include <CLI/App.hpp>
#include <memory>
#include <string>
#include <vector>

#include "sepcal/flight/flight.hpp"
#include "sepcal/flight/probe.hpp"
#include "sepcal/flight/simulate.hpp"

namespace sepcal::app {

/// A simulated flight and the truth behind it, as JSON.
struct Simulation {
  SimulatedFlight flight;
  std::string truth;
};

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

  /// `truth`: JSON, or empty for the defaults; `source` opens messages about it.
  virtual Simulation simulate(const std::string& truth, const std::string& source,
                              const SimulationOptions& options) const = 0;
};

/// Runs the app: parses the command line, carries out the verb, maps every error to one line on
/// standard error. Returns the exit code (0, 2, 4 or 5).
int run(Instrument& instrument, int argc, char** argv);

}  // namespace sepcal::app
