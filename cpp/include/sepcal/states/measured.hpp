// SPDX-License-Identifier: BSD-3-Clause
// One sample's outputs, of which some may be missing (NaN).
#pragma once

#include <cmath>

#include "sepcal/eigen.hpp"

namespace sepcal::states {

/// Residuals, their derivative and their covariance, without the outputs that are missing: these
/// have e = 0, a row of zeros in H and a row of the identity in R. Every equation then gives what
/// it gives for the outputs that are there, correlated or not, in matrices of the same size.
template <int NZ, int N>
struct Measured {
  Eigen::Vector<double, NZ> e;
  Eigen::Matrix<double, NZ, N> H;
  Eigen::Matrix<double, NZ, NZ> R;
  int count;  // outputs that are there

  /// y (NaN where missing) minus what was expected of it.
  Measured(const Eigen::Vector<double, NZ>& y, const Eigen::Vector<double, NZ>& expected,
           const Eigen::Matrix<double, NZ, N>& derivative,
           const Eigen::Matrix<double, NZ, NZ>& covariance)
      : e(y - expected), H(derivative), R(covariance), count(static_cast<int>(y.size())) {
    for (Eigen::Index j = 0; j < y.size(); ++j) {
      if (!std::isnan(y[j])) continue;
      e[j] = 0.0;
      H.row(j).setZero();
      R.row(j).setZero();
      R.col(j).setZero();
      R(j, j) = 1.0;
      --count;
    }
  }
};

}  // namespace sepcal::states
