// SPDX-License-Identifier: BSD-3-Clause
// The likelihood ratio of a candidate, and the distribution that it has where nothing is missing.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "diagnosis/noise_hypothesis.hpp"
#include "thread_pool.hpp"

namespace sepcal {

/// The fit without any candidate, in a noise model of its own.
struct NullHypothesis {
  const Linearisation* fit = nullptr;
  Eigen::MatrixXd basis = {};           // orthonormal, of the tangent
  Hypothesis best = {};                 // of the residual on the basis
  Eigen::MatrixXd white_basis = {};     // orthonormal, of the whitened tangent
  Eigen::VectorXd white_residual = {};  // whitened and orthogonal to white_basis
};

/// `fit` must outlive it.
NullHypothesis find_null(const Linearisation& fit);

/// `added`: orthonormal and orthogonal to the null's basis. Twice the logarithm of the ratio, not
/// negative, and the hypothesis with the columns [basis, added].
struct LikelihoodRatio {
  double value = 0.0;
  Hypothesis with = {};
};
LikelihoodRatio compare_with_null(const NullHypothesis& null, const Eigen::MatrixXd& added);

/// The first two moments of the ratio over simulations of the null.
struct RatioMoments {
  double mean = 0.0;
  double variance = 0.0;
};

/// Simulates the null's noise `simulations` times; records of more than a few thousand rows are
/// thinned out, which errs on the safe side.
RatioMoments simulate_ratio(const NullHypothesis& null, const Eigen::MatrixXd& added,
                            int simulations, std::uint64_t seed, ThreadPool& pool);

/// log10 of the probability of a larger ratio: of a gamma variable of those moments.
double log10_tail(double ratio, const RatioMoments& moments);

}  // namespace sepcal
