// SPDX-License-Identifier: BSD-3-Clause
// How far each parameter of a calibration may lie, by both kinds of interval, and what it predicts
// of a flight, with bands.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/calibration.hpp"
#include "sepcal/prediction.hpp"
#include "sepcal/profile.hpp"

namespace sepcal {

struct FlightIntervals {
  std::string model;
  FittedFlight flight;
  FitStatus status = FitStatus::not_converged;  // of the calibration, repeated
  std::string message = {};
  std::vector<std::string> at_bound = {};  // parameters of the calibration that a bound stopped
  double level = 0.95;
  std::vector<ProfileInterval> parameters = {};
  std::vector<std::string> notes = {};  // for people; not part of the JSON
};

/// Profiles the fit on the flight that was fitted. The times of steps stay where the scan found
/// them, and the noise that a magnetometer's model depends on is the fit's. Throws Error as
/// profile_intervals() does, for bad input, as calibrate() does, and for another file than the one
/// that was fitted.
FlightIntervals find_intervals(const Calibration& calibration, const Flight& flight,
                               const ProfileOptions& asked = {});

/// The JSON object: model, inputs, status, message, level, parameters {name: {value, gaussian [lo,
/// hi], profile [lo, hi], ends [...], message}}; null where a number is undefined or infinite.
std::string to_json(const FlightIntervals& intervals);

/// Only schema_version, level and parameters: of a fit without a flight.
std::string to_json(const std::vector<ProfileInterval>& parameters, double level);

/// The page that the apps print: both intervals of every parameter, and what ends them.
std::string to_text(const FlightIntervals& intervals, Detail detail = Detail::brief);

/// The same of a fit without a flight: the table alone.
std::string to_text(const std::vector<ProfileInterval>& parameters, double level);

struct FlightPrediction {
  std::vector<double> time;  // [s] of every row predicted
  Prediction prediction;
};

/// The calibrated model on any flight. Throws Error for bad input, as calibrate() does.
FlightPrediction predict(const Calibration& calibration, const Flight& flight, double level = 0.95);

}  // namespace sepcal
