// SPDX-License-Identifier: BSD-3-Clause
// The model against the measurements: how far off each output is, in which maneuver, against which
// channel and when, and whether the residuals are noise or still carry a shape (lag-one correlation
// near 0 or near 1).
#pragma once

#include <string>
#include <vector>

#include "sepcal/detail/eigen.hpp"
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

/// One output's residual against one channel: what share of its variance a straight line, and a
/// natural spline of six even knots, would explain. Noise alone gives the line 1 in N on average.
struct ChannelMisfit {
  std::string driver;  // "altitude_m"; "time", "alpha", "roll" for what the probe knows by itself
  std::string output;
  double share_line = 0.0;    // R^2 within [0, 1]
  double share_smooth = 0.0;  // at least share_line
  double slope = 0.0;         // of the line
  double slope_error = 0.0;   // its standard error in the residual's own noise, which need not be
                              // white and takes all of the residual for noise: rather too large
  std::string unit;           // of the slope: "m/s per m"
};

/// A stretch of about a twentieth of the rows.
struct Window {
  double first_s = 0.0;  // time of its first and last row
  double last_s = 0.0;
  std::size_t rows = 0;
  std::vector<OutputValue> rmse = {};
  std::vector<OutputValue> mean = {};  // of z - model
};

/// By filter error: a noise that drives a state, as the whole flight tells it, in its own standard
/// deviations (the auxiliary residual of Harvey & Koopman, JBES 10, 1992). Where the model is right
/// it is standard normal: beyond 3 in 0.27 % of the rows.
struct Disturbance {
  NoiseSize noise;  // of the fit
  double share_beyond =
      not_a_number;      // of the rows beyond 3; NaN of one that is none or at its floor
  std::size_t rows = 0;  // of the longest stretch beyond 3; 0: there is none
  double first_s = not_a_number;
  double last_s = not_a_number;
  double peak = 0.0;  // the largest in it, with its sign
};

/// A calibrated quantity against an independent sensor's column of the same log (Sun &
/// Gebre-Egziabher, Fig. 8). Standard errors allow for a coloured difference; NaN where the
/// reference doesn't move.
struct ReferenceMisfit {
  std::string quantity;    // "airspeed", "alpha", "mx"; "field" for the calibrated field's strength
  std::string unit;        // "m/s", of all numbers but the scales
  std::string calibrated;  // what apply calls it: "airspeed_cal_mps"
  std::string reference;   // what the log calls the other: "TAS_2 [kt]"
  std::size_t rows = 0;    // in which both are there
  double bias = 0.0;       // mean of calibrated - reference
  double bias_error = not_a_number;
  double rms = 0.0;  // of the difference
  double sd = 0.0;   // of the difference about its mean
  double lag_one = not_a_number;
  // Least squares of calibrated = offset + scale * reference. Noise of the reference makes this
  // scale smaller; scale_reversed, one over that of the reference on the calibrated, is made larger
  // by noise of the calibrated.
  double scale = not_a_number;
  double scale_error = not_a_number;
  double offset = not_a_number;
  double offset_error = not_a_number;
  double scale_reversed = not_a_number;
  Eigen::VectorXd time = {};        // [s] of these rows; row numbers where the log has no time
  Eigen::VectorXd difference = {};  // calibrated - reference; of angles within half a turn
  Eigen::VectorXd against = {};     // the reference's values
};

/// How well a model follows an output over all rows; y is what is modelled, by filter error one row
/// ahead. NaN where the output doesn't move.
struct OutputValidation {
  std::string output;
  double r_squared = not_a_number;  // 1 - sum (z - y)^2 / sum (z - mean z)^2, may be negative
  double theil = not_a_number;      // rms(z - y) / (rms(z) + rms(y)): 0 exact, 1 the worst
  // What the mean square of z - y is made of, as shares that sum to one: (mean z - mean y)^2,
  // (sd z - sd y)^2, 2 (1 - correlation) sd z sd y.
  double theil_bias = not_a_number;
  double theil_variance = not_a_number;
  double theil_covariance = not_a_number;
};

struct Comparison {
  std::string model;
  FittedFlight flight;  // the flight compared with, not the one fitted
  FitStatus status;     // of the calibration, repeated
  std::string message;
  std::vector<std::string> at_bound;  // parameters of the calibration that a bound stopped
  std::vector<Misfit> overall;        // one an output
  std::vector<Misfit> where;          // maneuver by maneuver, outputs within; in the flight's order
  std::vector<ChannelMisfit> channels;  // by share_smooth, largest first
  std::vector<Window> windows;          // the five worst in units of the fit's noise, worst first
  std::vector<std::string> notes;       // for people; not part of the JSON
  std::vector<double> time;             // [s] of every row used
  Eigen::MatrixXd residuals;      // rows x n_z, z - model; of a fit by filter error innovations
  Eigen::MatrixXd modelled = {};  // rows x n_z, z less them
  FitMethod method = FitMethod::output_error;
  std::vector<OutputValue> sigma = {};  // by filter error: rms of the innovations over the filter's
                                        // own standard deviations, 1 where it is right
  std::vector<Disturbance> disturbances = {};     // by filter error, one a process noise
  std::vector<OutputValidation> validation = {};  // one an output
  std::vector<ReferenceMisfit> references = {};   // one a column that was asked for
};

/// Runs of one label are taken together; a flight with fewer than two labels is cut into ten spans
/// of equal length. Channels are all numeric columns of the log and what the probe derives from
/// them, but for its outputs and what is constant. `references`: columns of independent sensors,
/// which what apply() calibrates is set against; "airspeed_kt=TAS 2" says what a column is that its
/// name doesn't tell, as a log's map does. Throws Error for bad input, as calibrate() does, and for
/// a reference that is not there, in no known unit or of no quantity that is calibrated.
Comparison compare(const Calibration& calibration, const Flight& flight,
                   const std::vector<std::string>& references = {});

/// Where the model would fail with `effect` added, for a look: no history, nothing promised. Throws
/// Error as add() does.
Comparison compare_with(const Calibration& base, const Flight& flight, const std::string& effect);

/// The JSON object: model, inputs, status, message, rmse {output}, residual {output: {lag_one}},
/// where [{segment, output, rows, rmse, mean, lag_one}], channels [{driver, output, share_line,
/// share_smooth, slope, slope_error, unit}], windows [{first_s, last_s, rows, rmse {output}, mean
/// {output}}], validation {output: {r_squared, theil, theil_bias, theil_variance,
/// theil_covariance}}, references [{quantity, unit, calibrated, reference, rows, bias, bias_error,
/// rms, sd, lag_one, scale, scale_error, offset, offset_error, scale_reversed, time_s,
/// difference}] where there are some, by filter error innovation {output: {lag_one, sigma}} and
/// disturbances [{name, size, unit, share_beyond, rows, first_s, last_s, peak}].
std::string to_json(const Comparison& comparison);

/// The page that the apps print: the error by maneuver, whether it is noise, the channels that
/// explain most of it, the worst windows.
std::string to_text(const Comparison& comparison, Detail detail = Detail::brief);

/// Whether lag_one is within 3 / sqrt(rows), three standard errors of white noise's about zero: of
/// noise alone one verdict in 370 is wrong, and noise whose neighbours correlate by 5 / sqrt(rows)
/// is told from it 98 times in a hundred. False where it is NaN.
bool is_white(const Misfit& misfit);

/// In words whether the residuals are noise: "white, as noise alone would be".
std::string verdict_on_noise(const Misfit& misfit);

}  // namespace sepcal
