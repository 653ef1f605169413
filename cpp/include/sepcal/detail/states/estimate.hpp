// SPDX-License-Identifier: BSD-3-Clause
// An estimated state with its covariance, kept as the triangular root of it.
#pragma once

#include "sepcal/detail/states/product.hpp"

namespace sepcal {

template <int NX, class Scalar = double>
struct Estimate {
  Eigen::Vector<Scalar, NX> x;         // n_x
  Eigen::Matrix<Scalar, NX, NX> root;  // U_P, upper triangular, P = U_P'U_P

  Eigen::Matrix<Scalar, NX, NX> covariance() const {
    return states::product(root.transpose(), root);
  }
};

}  // namespace sepcal
