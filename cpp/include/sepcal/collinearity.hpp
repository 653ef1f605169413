// SPDX-License-Identifier: BSD-3-Clause
// Which estimates a record hardly tells apart: correlated pairs, condition indices with the shares
// of each estimate's variance (Belsley, Kuh & Welsch, Regression Diagnostics, 1980, ch. 3), and
// ellipses of two estimates. Of the covariance that is believed, Fit::covariance.
#pragma once

#include <string>
#include <vector>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/fit.hpp"

namespace sepcal {

struct CorrelatedPair {
  std::string first;
  std::string second;
  double correlation = 0.0;
};

struct Collinearity {
  std::vector<std::string> names;     // k estimates that have a standard error
  std::vector<CorrelatedPair> pairs;  // |correlation| above 0.9, strongest first
  /// Largest singular value over each of J's, its columns scaled to unit length, J'J the inverse of
  /// the covariance: k, from 1 up. Infinite where that is singular. Above 10 columns begin to look
  /// like combinations of others, above 30 they hardly differ.
  Eigen::VectorXd condition_indices;
  /// k x k: what share of an estimate's variance (a column each, which sums to one) comes of the
  /// direction of each condition index (a row each). Two shares above a half in a row of a large
  /// index: these can't be told apart. NaN where J'J is singular.
  Eigen::MatrixXd variance_proportions;
};

Collinearity find_collinearity(const Fit& fit);

/// Points (`points` x 2, the last one the first) on the ellipse that holds both true values
/// together in `level` of all records, by the normal distribution. Throws Error for a parameter
/// that isn't there, is named twice or has no standard error, a level outside (0, 1) and fewer than
/// four points.
Eigen::MatrixXd confidence_ellipse(const Fit& fit, const std::string& first,
                                   const std::string& second, double level = 0.95, int points = 73);

}  // namespace sepcal
