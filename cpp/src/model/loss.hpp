// SPDX-License-Identifier: BSD-3-Clause
// Losses that forgive outliers: a whitened residual s costs rho(s) and not s^2. rho is even, zero
// at zero and concave in s^2, so that rows weighted by w(s) = d rho / d(s^2) have its gradient, and
// sum rho exceeds their squares by something that is no less than zero. Huber & Ronchetti, Robust
// Statistics, Secs. 3.5, 6.4, 7.7.
#pragma once

#include <Eigen/Core>

#include "sepcal/detail/choices.hpp"

namespace sepcal::model {

class RobustLoss {
 public:
  /// `loss` huber or cauchy; width k > 0, in standard deviations, or 0 for the loss's own.
  RobustLoss(Loss loss, double width);

  double cost(double s) const;                                // rho
  double weight(double s) const;                              // w = rho' with respect to s^2
  double influence(double s) const { return s * weight(s); }  // psi = (d rho / ds) / 2
  double slope(double s) const;                               // d psi / ds

  /// Standard deviation of normal noise with some outliers: Huber's proposal 2,
  ///   sum_i min(|r_i| / sigma, c)^2 = N E min(|v|, c)^2,  v normal,
  /// c = k for huber, for which the cost is then convex in the parameters and sigma together, and
  /// 1.345 for cauchy, whose own influence would leave several solutions. The root mean square
  /// where c is large; 0 where too many residuals are zero to tell.
  double scale(const Eigen::Ref<const Eigen::VectorXd>& residual) const;

 private:
  Loss loss_;
  double width_;
};

}  // namespace sepcal::model
