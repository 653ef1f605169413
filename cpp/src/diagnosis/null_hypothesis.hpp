// SPDX-License-Identifier: BSD-3-Clause
// The hypothesis that nothing is missing, from which every candidate is judged.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "diagnosis/noise_hypothesis.hpp"
#include "diagnosis/noise_test.hpp"
#include "diagnosis/projection.hpp"

namespace sepcal::diagnosis {

/// The fit without any candidate, in a noise model of its own.
struct NullHypothesis {
  TangentBasis basis = {};
  Eigen::VectorXd residual = {};               // beyond the tangent
  Hypothesis best = {};                        // of the residual on the basis, in noise of its own
  std::vector<Whitener> whiteners = {};        // of each used output, in that noise or as given
  Eigen::MatrixXd white_basis = {};            // orthonormal, of the whitened tangent
  Eigen::VectorXd white_residual = {};         // whitened and orthogonal to white_basis
  std::shared_ptr<const NoiseTest> test = {};  // in noise of its own

  const LinearisedFit& fit() const { return basis.fit(); }
  void whiten(Eigen::MatrixXd& columns) const;  // of count() rows

  /// The whitened residual of each output, side by side (N x outputs).
  Eigen::MatrixXd white_outputs() const {
    return white_residual.reshaped(fit().layout.rows, std::ssize(fit().layout.outputs));
  }
};

/// Without its noise. `fit` must outlive it.
NullHypothesis find_plain_null(const LinearisedFit& fit);

/// In the noise of another to the same rows. `fit` must outlive it.
NullHypothesis find_null(const LinearisedFit& fit, std::vector<Whitener> whiteners);

/// `fit` must outlive it.
NullHypothesis find_null(const LinearisedFit& fit);

/// What of the fit's RMSE over all outputs goes, 1 - after / before, once columns that are
/// orthonormal and orthogonal to the null's basis join it.
double predict_drop(const NullHypothesis& null, const Columns& added);

}  // namespace sepcal::diagnosis
