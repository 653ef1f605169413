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

inline Flight make_flight(const SimulatedFlight& simulated) {
  Flight flight("flight");
  for (const SimulatedColumn& column : simulated.columns) flight.add(column.name, column.values);
  return flight.label(simulated.maneuver);
}

/// The probe that FiveHoleTruth simulates.
inline std::shared_ptr<const Probe> make_five_hole() {
  return five_hole_probe(4.5, 4.5, {0.35, 0.0, -0.02});
}

/// The model's parameters in its order, from values by name.
inline Eigen::VectorXd order_values(const Probe& probe,
                                    const std::map<std::string, double>& by_name) {
  const auto parameters = probe.model().tables().parameters();
  Eigen::VectorXd values(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    values[static_cast<Eigen::Index>(k)] = by_name.at(parameters[k].name);
  }
  return values;
}

/// A calibration whose parameters are these values: nothing was fitted.
inline Calibration make_calibration(const std::shared_ptr<const Probe>& probe,
                                    const std::map<std::string, double>& by_name) {
  Calibration calibration;
  calibration.probe = probe;
  calibration.fit.status = FitStatus::converged;
  calibration.fit.n_1 = probe->model().tables().n_1();
  for (const Variable& variable : probe->model().tables().parameters()) {
    calibration.fit.parameters.push_back(
        {.name = variable.name, .unit = variable.unit, .value = by_name.at(variable.name)});
  }
  return calibration;
}

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
