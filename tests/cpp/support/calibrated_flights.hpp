// SPDX-License-Identifier: BSD-3-Clause
// Short simulated flights as tables, calibrations of them, and refusals looked at word by word.
#pragma once

#include <doctest/doctest.h>

#include <initializer_list>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/error.hpp"
#include "sepcal/flight/calibration.hpp"
#include "simulated_flights.hpp"

namespace sepcal::test {

Flight make_flight(const SimulatedFlight& simulated);

/// The probe that FiveHoleTruth simulates.
std::shared_ptr<const Probe> make_five_hole();

/// The model's parameters in its order, from values by name.
Eigen::VectorXd order_values(const Probe& probe, const std::map<std::string, double>& by_name);

/// A calibration whose parameters are these values: nothing was fitted.
Calibration make_calibration(const std::shared_ptr<const Probe>& probe,
                             const std::map<std::string, double>& by_name);

/// Fails unless `act` throws Error in one line with all of `words`.
template <class Act>
void check_refused(const Act& act, std::initializer_list<std::string_view> words) {
  try {
    act();
    FAIL_CHECK("nothing was thrown");
  } catch (const Error& error) {
    const std::string what = error.what();
    CAPTURE(what);
    CHECK(what.find('\n') == std::string::npos);
    for (const std::string_view word : words) {
      CAPTURE(word);
      CHECK(what.find(word) != std::string::npos);
    }
  }
}

}  // namespace sepcal::test
