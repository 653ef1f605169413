// SPDX-License-Identifier: BSD-3-Clause
// The hypothesis that nothing is missing, from which every candidate is judged.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "diagnosis/noise_hypothesis.hpp"
#include "diagnosis/noise_test.hpp"

namespace sepcal::diagnosis {

/// The fit without any candidate, in a noise model of its own.
struct NullHypothesis {
  const Linearisation* fit = nullptr;
  Eigen::MatrixXd basis = {};           // orthonormal, of the tangent
  Hypothesis best = {};                 // of the residual on the basis
  Eigen::MatrixXd white_basis = {};     // orthonormal, of the whitened tangent
  Eigen::VectorXd white_residual = {};  // whitened and orthogonal to white_basis
  std::shared_ptr<const NoiseTest> test = {};
};

/// `fit` must outlive it.
NullHypothesis find_null(const Linearisation& fit);

/// What of the fit's RMSE over all outputs goes, 1 - after / before, once columns that are
/// orthonormal and orthogonal to the null's basis join it.
double predict_drop(const NullHypothesis& null, const Eigen::MatrixXd& added);

}  // namespace sepcal::diagnosis
