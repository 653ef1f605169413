// SPDX-License-Identifier: BSD-3-Clause
// A fit by filter error against a flight: what its filter didn't foresee, and when the noise that
// drives the states was more than noise.
#pragma once

#include "flight/aircraft/laid_aircraft.hpp"
#include "sepcal/flight/comparison.hpp"

namespace sepcal::aircraft_log {

/// Innovations and their standard deviations, rows of the segments x n_z.
struct FlightInnovations {
  Eigen::MatrixXd e;
  Eigen::MatrixXd sd;
};

/// `at`: the fit on the flight that is laid.
FlightInnovations innovations_on(const LaidAircraft& laid, const Fit& at);

/// Fills sigma and disturbances. `result` has the times of the rows.
void judge_by_filter(Comparison& result, const FlightInnovations& innovations,
                     const AircraftFit& fitted, const Fit& at, const LaidAircraft& laid);

}  // namespace sepcal::aircraft_log
