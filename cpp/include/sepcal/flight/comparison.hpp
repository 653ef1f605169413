// SPDX-License-Identifier: BSD-3-Clause
// The model against the measurements: how far off each output is, in which maneuver, and whether
// the residuals are noise or still carry a shape (lag-one correlation near 0 or near 1).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sepcal/flight/calibration.hpp"

namespace sepcal {

/// One output over one stretch of a flight. Undefined numbers (too few rows) are NaN.
struct Misfit {
  std::string segment;  // maneuver, or "120.0:180.5" [s] where there are no labels
  std::string output;
  std::string unit;
  std::size_t rows = 0;
  double rmse = 0.0;     // in the output's unit
  double mean = 0.0;     // of z - model: what a constant offset would explain
  double lag_one = 0.0;  // correlation of neighbouring residuals, never across a segment's edge
};

struct Comparison {
  std::string model;
  FittedFlight flight;  // the flight compared with, not the one fitted
  FitStatus status;     // of the calibration, repeated
  std::string message;
  std::vector<Misfit> overall;     // one an output
  std::vector<Misfit> where;       // maneuver by maneuver, outputs within; in the flight's order
  std::vector<std::string> notes;  // for people; not part of the JSON
  std::vector<double> time;        // [s] of every row used
  Eigen::MatrixXd residuals;       // rows x n_z, z - model
};

/// Runs of one label are taken together; a flight with fewer than two labels is cut into ten spans
/// of equal length. Throws Error for bad input, as calibrate() does.
Comparison compare(const Calibration& calibration, const Flight& flight);

/// The JSON object: model, inputs, status, message, rmse {output}, residual {output: {lag_one}},
/// where [{segment, output, rows, rmse, mean, lag_one}].
std::string to_json(const Comparison& comparison);

}  // namespace sepcal
