// SPDX-License-Identifier: BSD-3-Clause
// One sample's outputs, of which some may be missing (NaN).
#pragma once

#include <cmath>

#include "sepcal/detail/eigen.hpp"

namespace sepcal::states {

/// Residuals, their derivative and their covariance, without the outputs that are missing: these
/// have e = 0, a row of zeros in H and a row of the identity in R. Every equation then gives what
/// it gives for the outputs that are there, correlated or not, in matrices of the same size.
template <int NZ, int N, class Scalar>
struct Measured {
  Eigen::Vector<Scalar, NZ> e;
  Eigen::Matrix<Scalar, NZ, N> H;
  Eigen::Matrix<Scalar, NZ, NZ> R;
  int count;  // outputs that are there

  /// y (NaN where missing) minus what was expected of it.
  Measured(const Eigen::Vector<Scalar, NZ>& y, const Eigen::Vector<Scalar, NZ>& expected,
           const Eigen::Matrix<Scalar, NZ, N>& derivative,
           const Eigen::Matrix<Scalar, NZ, NZ>& covariance)
      : e(y - expected), H(derivative), R(covariance), count(static_cast<int>(y.size())) {
    for (Eigen::Index j = 0; j < y.size(); ++j) {
      if (!std::isnan(y[j])) continue;
      e[j] = 0;
      H.row(j).setZero();
      R.row(j).setZero();
      R.col(j).setZero();
      R(j, j) = 1;
      --count;
    }
  }
};

template <class Scalar, int NZ, int N>
Measured(const Eigen::Matrix<Scalar, NZ, 1>&, const Eigen::Matrix<Scalar, NZ, 1>&,
         const Eigen::Matrix<Scalar, NZ, N>&, const Eigen::Matrix<Scalar, NZ, NZ>&)
    -> Measured<NZ, N, Scalar>;

}  // namespace sepcal::states
