// SPDX-License-Identifier: BSD-3-Clause
// Stage one: sample xi2, solve xi1 by linear least squares with R = I at each sample, and look at
// Tr[R](xi2) (Sun & Gebre-Egziabher, Eqs. 16, 19, Steps 2-4): where its minima are, whether there
// is one, and along which directions it is flat.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sepcal/block_model.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// A local minimum of Tr[R] within the bounds.
struct LocalMinimum {
  Eigen::VectorXd xi2;   // n_2
  double trace_r = 0.0;  // sum over outputs of the mean squared residual, in the outputs' units
};

struct StageOne {
  Eigen::MatrixXd samples;  // n_2 x S
  Eigen::VectorXd trace_r;  // S; infinite where the model is not finite
  Eigen::VectorXd best;     // n_2: the sample with the least Tr[R]
  double best_trace_r = 0.0;

  /// Distinct local minima, lowest first: where descents end that begin in the deepest basins of
  /// the samples. Two are the same where the record can't tell them apart: closer than a standard
  /// error, or joined along a flat direction.
  std::vector<LocalMinimum> minima;

  /// Directions, in words, along which half the width of the bounds changes the sum of squares by
  /// less than two standard errors would: Tr[R] has a valley and no point (the paper's Fig. 6).
  std::vector<std::string> flat_directions;

  /// One minimum and no flat direction: the condition of Step 5 for estimating xi2 alone.
  bool unique_minimum = false;

  /// What stage two starts from.
  Eigen::VectorXd xi1;    // n_1, linear least squares at xi2 with R = I
  Eigen::VectorXd xi2;    // n_2, the lowest minimum
  Eigen::VectorXd noise;  // n_z, root mean square residual there by output
};

/// Throws Error for misuse: unknown names in `options`, a parameter that can't be sampled, fewer
/// measurements than parameters, columns missing from the record, a model that is nowhere finite.
StageOne stage_one(const BlockModel& model, const Record& record, const FitOptions& options = {});

}  // namespace sepcal
