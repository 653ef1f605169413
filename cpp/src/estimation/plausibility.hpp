// SPDX-License-Identifier: BSD-3-Clause
// How far a parameter may plausibly lie: the measure for "not determined by this record", and for
// what holds an estimate where the record says nothing.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/measurements.hpp"
#include "sepcal/detail/triangular_factor.hpp"

namespace sepcal::estimation {

/// Half the width of the bounds, or rms(z) / rms(column) for a parameter without two finite ones;
/// columns and z unwhitened, over all outputs. `factors`: n_z, of [A | D | r], not whitened.
Eigen::VectorXd plausible_scale(const std::vector<Variable>& parameters,
                                const std::vector<TriangularFactor>& factors,
                                const model::Measurements& measurements);

/// The same where `z_square` is the sum of z^2 over all outputs.
Eigen::VectorXd plausible_scale(const std::vector<Variable>& parameters,
                                const std::vector<TriangularFactor>& factors, double z_square);

/// The same from the columns' squares themselves, one a parameter.
Eigen::VectorXd plausible_scale(const std::vector<Variable>& parameters,
                                const Eigen::VectorXd& column_squares, double z_square);

/// Independent normal priors of the parameters: each is one row of the factor.
struct Prior {
  Eigen::VectorXd mean;    // n
  Eigen::VectorXd weight;  // n, 1 / standard deviation; 0: none

  /// Sum of squares that the prior adds at x.
  double square(const Eigen::VectorXd& x) const {
    return (mean - x).cwiseProduct(weight).squaredNorm();
  }

  /// Of the first and of the last parameters alone.
  Prior head(Eigen::Index count) const { return {mean.head(count), weight.head(count)}; }
  Prior tail(Eigen::Index count) const { return {mean.tail(count), weight.tail(count)}; }

  /// Merges the rows [diag(weight) | weight (mean - x)] into a whitened factor of [A | D | r].
  void join(TriangularFactor& factor, const Eigen::VectorXd& x) const;
};

/// A prior so wide that it moves nothing the record determines, and that keeps what it leaves open
/// within ten plausible lengths of the middle of the bounds, or of zero.
Prior loose_prior(const std::vector<Variable>& parameters, const Eigen::VectorXd& scale);

}  // namespace sepcal::estimation
