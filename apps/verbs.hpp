// SPDX-License-Identifier: BSD-3-Clause
// What each verb does, once its arguments are read. Results go to their files first, then to
// standard output, for people or as JSON; notes and progress to standard error.
#pragma once

#include <string>

#include "instrument.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal::app {

struct Arguments {
  std::string flight;
  std::string calibration;
  std::string output;
  std::string truth;
  bool json = false;
};

/// Each returns the exit code: 0, or what the fit's status says (4 not identifiable, 5 not
/// converged). All throw Error for bad input; nothing is written then.
class Verbs {
 public:
  Verbs(const Instrument& instrument, const Arguments& arguments)
      : instrument_(instrument), arguments_(arguments) {}

  int fit(CalibrationOptions options) const;
  int compare() const;
  int apply() const;
  int simulate(const SimulationOptions& options) const;
  int effects() const;

 private:
  /// Reads FLIGHT with its progress shown.
  Flight read_flight() const;

  const Instrument& instrument_;
  const Arguments& arguments_;
};

}  // namespace sepcal::app
