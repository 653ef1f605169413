// SPDX-License-Identifier: BSD-3-Clause
// The two-stage batch estimator (Sun & Gebre-Egziabher): sample xi2 and solve xi1 linearly, then
// fit by constrained maximum likelihood. What sepcal exists for, in one call.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/identifiability.hpp"
#include "sepcal/detail/model.hpp"
#include "sepcal/detail/passes.hpp"
#include "sepcal/detail/stage_one.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

enum class FitStatus { converged, not_converged, not_identifiable };

/// "converged", "not_converged", "not_identifiable".
std::string_view to_string(FitStatus status);

struct Parameter {
  std::string name;
  std::string unit;
  double value = 0.0;
  double standard_error = 0.0;        // the one to believe; NaN where undefined: fixed, at a bound,
                                      // singular
  double standard_error_white = 0.0;  // what it would be if the residuals were white
  double standard_error_noise_model = not_a_number;  // by a noise model of each output's residual
  double standard_error_blocks = not_a_number;  // by leaving out blocks of the record; NaN also
                                                // where too few blocks determine the parameter
  double lower = -infinity;
  double upper = infinity;
  bool at_bound = false;
  bool fixed = false;
};

/// One value an output.
struct OutputValue {
  std::string name;
  double value = 0.0;
};

/// A noise's size that filter error estimated, or was given.
struct NoiseSize {
  std::string name;  // "q_alpha" of a process noise, "r_alpha_m" of an output
  std::string unit;
  double value = 0.0;           // root of the spectral density; of an output the standard deviation
  double standard_error = 0.0;  // NaN: given, or at its floor
  bool at_floor = false;        // nothing but the floor stopped it: see Fit::message
};

struct Fit {
  FitStatus status = FitStatus::not_converged;
  std::string message;  // one line; empty where there is nothing to say

  /// Linear, then nonlinear, in the model's order; fixed ones among them.
  std::vector<Parameter> parameters;
  int n_1 = 0;  // how many of them are linear

  /// Covariance of the estimates (n x n, parameters' order), behind standard_error and correlation,
  /// as the way to believe has it (docs/method.md): nearly always the noise model. The white one by
  /// FitOptions::coloured_errors. NaN in the rows of parameters without a standard error.
  Eigen::MatrixXd covariance;
  Eigen::MatrixXd correlation;
  /// The same for white residuals: (J' R^-1 J)^-1, times M / (M - n) where R was estimated, M =
  /// rows x outputs. Of a calibration that was read from JSON: its diagonal, NaN elsewhere.
  Eigen::MatrixXd covariance_white;
  /// As the noise model of each output's residual has it; of an output that has none, the white
  /// one. Of a calibration that was read, like covariance_white.
  Eigen::MatrixXd covariance_noise_model;
  /// As it is among blocks of the record, whatever the noise (delete-a-block jackknife). NaN for
  /// what too few blocks determine. Of a calibration that was read, like covariance_white.
  Eigen::MatrixXd covariance_blocks;

  std::vector<OutputValue> noise;  // standard deviation: given, or from R-hat = SSE / N
  std::vector<OutputValue>
      rmse;           // unwhitened, in the output's unit; by filter error of innovations
  double cost = 0.0;  // J of Eq. 6; by filter error V_m (S 5.7)

  FitMethod method = FitMethod::output_error;
  std::vector<NoiseSize> noise_sizes = {};       // by filter error: process noises, then outputs
  double log_likelihood = not_a_number;          // by filter error
  double log_likelihood_without = not_a_number;  // output error's from which it began: without the
                                                 // process noises
  Identifiability identifiability;

  StageOne stage_one;
  SecondStage second_stage =
      SecondStage::joint;    // joint or projected, what stage two used in the end
  int iterations = 0;        // of stage two's minimisations
  int noise_iterations = 0;  // of R against the parameters
  std::size_t rows = 0;      // that stage two used
  Passes stage_two_passes;   // StageOne::passes has stage one's
  Passes last_passes;        // for covariance, noise of the residuals and status

  /// Throws Error for a name that is not a parameter.
  const Parameter& operator[](std::string_view name) const;

  Eigen::VectorXd values() const;  // n
  std::map<std::string, double> by_name() const;
  /// The nonlinear parameters that were estimated: where another fit begins (FitOptions::start).
  std::map<std::string, double> nonlinear_estimates() const;
  /// By filter error, each process noise by its name: root of the spectral density.
  std::map<std::string, double> process_noise() const;
  Eigen::VectorXd xi1() const { return values().head(n_1); }
  Eigen::VectorXd xi2() const { return values().tail(values().size() - n_1); }
};

/// Fits `model` to `record`. Non-convergence and what the record does not determine are statuses of
/// the result; misuse throws Error (see stage_one(), check_model()).
Fit fit(const BlockModel& model, const Record& record, const FitOptions& options = {});

template <SeparableModel M>
Fit fit(const M& model, const Record& record, const FitOptions& options = {}) {
  return fit(StaticModel<M>(model), record, options);
}

}  // namespace sepcal
