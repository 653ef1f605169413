// SPDX-License-Identifier: BSD-3-Clause
// Stage one: sample xi2, or search it, solve xi1 by linear least squares with R = I at each sample,
// and look at Tr[R](xi2) (Sun & Gebre-Egziabher, Eqs. 16, 19, Steps 2-4): where its minima are,
// whether there is one, and along which directions it is flat.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/passes.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// A local minimum of Tr[R] within the bounds of xi2; xi1 is the best within its own there.
struct LocalMinimum {
  Eigen::VectorXd xi2;   // n_2
  double trace_r = 0.0;  // sum over outputs of the mean squared residual, in the outputs' units
};

/// Eqs. 17 and 18 at every sample, A and b stacked over the record, norms Frobenius'. Where A or b
/// does not depend on xi2 (b = 0 among others) its ratio is zero and both conditions are met.
struct ScreenResults {
  Eigen::VectorXd ratio_a;  // S: |dA/dxi2| l_2 / |A|, Eq. 17, xi2 in its units
  Eigen::VectorXd ratio_b;  // S: |db/dxi2| l_2 / |b|
  /// S: the smallest eigenvalue of the sum of A's second derivatives, xi2 in units of half the
  /// width of the bounds; Eq. 18 asks for a positive one. It changes sign with the sign of A's
  /// columns.
  Eigen::VectorXd curvature_a;
  Eigen::VectorXd curvature_b;                     // S: the same of b
  Eigen::Array<bool, Eigen::Dynamic, 1> accepted;  // S
};

struct StageOne {
  /// Points at which Tr[R] was asked for: drawn, or where a global search went, in its order.
  Eigen::MatrixXd samples;  // n_2 x S
  Eigen::VectorXd trace_r;  // S; infinite where the model is not finite
  Eigen::VectorXd best;     // n_2: the sample with the least Tr[R]
  double best_trace_r = 0.0;

  /// Where options.screens asks for it. Rejected samples keep their Tr[R], but none is `best` and
  /// no descent begins at one.
  std::optional<ScreenResults> screens = {};

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

  Passes passes;  // of the descents and of what tells minima apart
};

/// Throws Error for misuse: unknown names in `options`, a parameter that can't be sampled, fewer
/// measurements than parameters, columns missing from the record, a model that is nowhere finite,
/// screens that reject every sample.
StageOne stage_one(const BlockModel& model, const Record& record, const FitOptions& options = {});

}  // namespace sepcal
