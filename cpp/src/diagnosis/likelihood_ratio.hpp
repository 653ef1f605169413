// SPDX-License-Identifier: BSD-3-Clause
// The likelihood ratio of a candidate, and the distribution that it has where nothing is missing.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "base/thread_pool.hpp"
#include "diagnosis/noise_hypothesis.hpp"

namespace sepcal::diagnosis {

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

/// What of the fit's RMSE over all outputs goes, 1 - after / before, once columns that are
/// orthonormal and orthogonal to the null's basis join it.
double predict_drop(const NullHypothesis& null, const Eigen::MatrixXd& added);

/// `added`: orthonormal and orthogonal to the null's basis. Twice the logarithm of the ratio, not
/// negative, and the hypothesis with the columns [basis, added].
struct LikelihoodRatio {
  double value = 0.0;
  Hypothesis with = {};
};
LikelihoodRatio compare_with_null(const NullHypothesis& null, const Eigen::MatrixXd& added);

/// The ratio on simulations without the effect, in the null's noise; its innovations keep their
/// sizes. Records of more than a few hundred rows are thinned out, which errs on the safe side.
Eigen::VectorXd simulate_ratios(const NullHypothesis& null, const Eigen::MatrixXd& added,
                                int simulations, std::uint64_t seed, base::ThreadPool& pool);

/// How much larger the median and the ninetieth percentile of a ratio are than chi-squared's, each
/// at least 1. The largest ratios don't count: where a search ends in a poor optimum it makes one
/// of any size.
struct Inflation {
  double median = 1.0;
  double ninetieth = 1.0;
};
Inflation inflation_of(const Eigen::VectorXd& ratios, int freedom);

/// log10 of the probability of a larger ratio: of the gamma variable whose two percentiles are
/// those of chi-squared, inflated.
double log10_ratio_tail(double ratio, int freedom, const Inflation& inflation);

}  // namespace sepcal::diagnosis
