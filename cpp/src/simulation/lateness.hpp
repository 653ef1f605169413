// SPDX-License-Identifier: BSD-3-Clause
// How late a sensor's readings are: by time_offset all along, and by clock_drift from nothing at
// the record's first row to all of it at the last.
#pragma once

#include <string>
#include <vector>

#include "simulation/hidden_effects.hpp"

namespace sepcal::simulation {

class Lateness {
 public:
  /// `times` of the rows [s]. Throws Error, opened by `source`, as check_shift() does.
  Lateness(const HiddenEffects& hidden, const std::vector<double>& times, const std::string& source)
      : always_(check_shift(source + ": time_offset", hidden.constant("time_offset"))),
        at_last_(check_shift(source + ": clock_drift", hidden.constant("clock_drift"))),
        first_(times.front()),
        span_(times.back() - times.front()) {
    check_shift(source + ": time_offset and clock_drift", always_ + at_last_);
  }

  bool none() const { return always_ == 0.0 && at_last_ == 0.0; }

  /// At a row's time [s].
  double at(double time) const {
    return at_last_ == 0.0 ? always_ : always_ + at_last_ * (time - first_) / span_;
  }

 private:
  double always_;
  double at_last_;
  double first_;
  double span_;
};

}  // namespace sepcal::simulation
