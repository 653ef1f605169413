// SPDX-License-Identifier: BSD-3-Clause
// Many trials of one design, as a Monte Carlo study has them: one model, the same inputs in every
// trial, and other measurements. Trials are fitted side by side, one in each lane of the
// processor's registers; what those can't do, fit() does one by one, with the same result.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/eigen.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// One output's measurements in all trials.
struct TrialOutput {
  std::string name;
  std::span<const double> values;  // K x N, trial after trial, a value for each row of the record
};

struct TrialFits {
  std::vector<std::string> names;     // n parameters, linear, then nonlinear, fixed ones among them
  Eigen::MatrixXd estimates;          // K x n; NaN where a trial could not be fitted
  Eigen::MatrixXd standard_errors;    // K x n; NaN where undefined: fixed, at a bound, singular
  Eigen::MatrixXd squared_residuals;  // K x n_z, sums over the rows of the fit
  std::vector<FitStatus> status;      // K
  std::vector<bool> in_lanes;         // K; false: fit() did it
  std::size_t estimated = 0;          // of the n parameters, those that are not fixed
  std::size_t rows = 0;               // of each fit
  std::map<std::size_t, std::string> messages;  // Fit::message by trial, where there is one
  std::map<std::size_t, std::string> failures;  // why a trial could not be fitted: fit()'s Error
};

/// Fits `model` to every trial: the inputs and segments of `design`, the measurements of `outputs`.
///
/// A trial goes in lanes where the model has them (StaticModel, with parameters fixed or free), its
/// standard errors are the white ones (coloured_errors = false), and it has no loss, prior or
/// screens and one choice of segments. It begins at options.start, in the middle of the bounds
/// (samples = 0), or, with descents = 1, at the best of the samples of xi2, with xi1 solved there:
/// lanes don't tell minima apart, which takes more descents. What ends at a bound, does not
/// converge or is not determined goes to fit() as it is.
///
/// The result does not depend on options.threads; an estimate in lanes is that of fit() within 1e-9
/// standard errors where both end in the same minimum. Throws Error for misuse, as fit() does; what
/// is wrong with one trial alone is its failure.
TrialFits fit_trials(const BlockModel& model, const Record& design,
                     const std::vector<TrialOutput>& outputs, const FitOptions& options = {});

template <SeparableModel M>
TrialFits fit_trials(const M& model, const Record& design, const std::vector<TrialOutput>& outputs,
                     const FitOptions& options = {}) {
  return fit_trials(StaticModel<M>(model), design, outputs, options);
}

}  // namespace sepcal
