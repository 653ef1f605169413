// SPDX-License-Identifier: BSD-3-Clause
// What a fit says of samples that need not have been measured: z = A xi1 + b, its standard error
// sqrt(g' Cov g) with g a row of [A D], and that of a new measurement, with the output's noise.
#pragma once

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/model.hpp"
#include "sepcal/fit.hpp"

namespace sepcal {

/// Over the rows of the record's segments, each in the outputs' units.
struct Prediction {
  Eigen::MatrixXd value;           // N x n_z
  Eigen::MatrixXd standard_error;  // N x n_z, of the value
  /// N x n_z, standard deviation of a new measurement about it. Of a fit by filter error what
  /// drives the states adds to it, as a trajectory has gathered it since its start.
  Eigen::MatrixXd measurement_error;
  /// Half of either band in these errors: Student's quantile with M - n degrees of freedom, the
  /// normal's where R is given.
  double quantile = 0.0;
};

/// `record` needs the inputs alone. `options`: of the fit, of which the noise and the threads are
/// used. By Fit::covariance, which allows for coloured residuals; parameters that are held or at a
/// bound take no part in it. A covariance that is not defined gives NaN errors. Throws Error for an
/// input that is missing or not finite, a model of other parameters, and a level outside (0, 1).
Prediction predict(const BlockModel& model, const Record& record, const Fit& fit,
                   const FitOptions& options = {}, double level = 0.95);

template <SeparableModel M>
Prediction predict(const M& model, const Record& record, const Fit& fit,
                   const FitOptions& options = {}, double level = 0.95) {
  return predict(StaticModel<M>(model), record, fit, options, level);
}

}  // namespace sepcal
