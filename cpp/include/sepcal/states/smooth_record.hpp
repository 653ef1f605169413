// SPDX-License-Identifier: BSD-3-Clause
// States and process noise along a record, given all of it: the extended filter and the smoother,
// S 2.20 to 2.23, at the parameters of a fit.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/states/state_steps.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

struct SmoothingNoise {
  /// Root of the spectral density by name of the model's table `noise`, in its unit (of a model in
  /// discrete time: standard deviation a row); those not named are none.
  std::map<std::string, double> process = {};
  /// Standard deviation of every output (Fit::noise).
  std::map<std::string, double> outputs = {};
  /// Standard deviation of states at the start about the parameters' `alpha_0`; of those not named
  /// ten times the largest value that the state has on the way without process noise.
  std::map<std::string, double> start = {};
};

/// Errors of parameters that are not known exactly, as of a fit.
struct ParameterErrors {
  std::vector<std::string> names;
  Eigen::MatrixXd covariance;  // by these names
};

/// Of a fit's parameters that were estimated and have a standard error.
ParameterErrors errors_of(const Fit& fit);

/// Rows as in the record; NaN outside its segments.
struct SmoothedRecord {
  std::vector<std::string> states;   // that are integrated, n_x
  std::vector<std::string> noises;   // n_w, of the table `noise`
  std::vector<std::string> outputs;  // n_z
  Eigen::MatrixXd x;                 // rows x n_x: x(k|N)
  std::vector<Eigen::MatrixXd> P;    // rows of n_x x n_x: P(k|N)
  /// rows x n_w: w(k|N), the mean from row k to the next of the noise, in its unit before the root;
  /// zero in a segment's last row.
  Eigen::MatrixXd w;
  std::vector<Eigen::MatrixXd> Q;  // rows of n_w x n_w: Q(k|N)
  Eigen::MatrixXd innovations;     // rows x n_z: y - h(x(k|k-1)); NaN where y is missing
  Eigen::MatrixXd innovation_sd;   // rows x n_z, by Lambda(k|k-1)
  double cost = 0.0;               // V_m, S 5.7: sum of (e'Lambda^-1 e + ln det Lambda) / 2
  std::size_t readings = 0;        // outputs that were there; -ln L = cost + readings ln(2 pi) / 2
};

/// `model` is one for this record (or for any), `parameters` are all of its own, by name. Outputs
/// may be missing, NaN. Between rows a noise is a mean and a slope (noise_parts()). Throws Error
/// where there is no process noise or a name is unknown, for a parameter or an output's noise that
/// is missing, for an input that is not finite, and where the filter can't go on, naming the row.
/// With `errors` P and Q are those of x and w whose parameters are as uncertain as said, to first
/// order: what each axis of the errors does to the states goes along with them, by the derivatives
/// of every step, with the gains as they are (which change only what the innovations do). Initial
/// states are not among them: the smoother has its own.
SmoothedRecord smooth(const StateBlockModel& model, const Record& record,
                      const std::map<std::string, double>& parameters, const SmoothingNoise& noise,
                      const ParameterErrors& errors = {});

}  // namespace sepcal
