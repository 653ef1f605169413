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

/// The ratio on simulations of the null, whose own innovations keep their sizes; records of more
/// than a few hundred rows are thinned out, which errs on the safe side.
Eigen::VectorXd simulate_ratios(const NullHypothesis& null, const Eigen::MatrixXd& added,
                                int simulations, std::uint64_t seed, ThreadPool& pool);

/// What chi-squared with `freedom` degrees is to be multiplied by, at least 1, to have the median
/// and the ninetieth percentile of `ratios`. The largest few don't count: where a search ends in a
/// poor optimum it makes a ratio of any size.
double inflation_of(const Eigen::VectorXd& ratios, int freedom);

}  // namespace sepcal
