// SPDX-License-Identifier: BSD-3-Clause
// An estimated state with its covariance, kept as the triangular root of it.
#pragma once

#include "sepcal/states/product.hpp"

namespace sepcal {

template <int NX>
struct Estimate {
  Eigen::Vector<double, NX> x;         // n_x
  Eigen::Matrix<double, NX, NX> root;  // U_P, upper triangular, P = U_P'U_P

  Eigen::Matrix<double, NX, NX> covariance() const {
    return states::product(root.transpose(), root);
  }
};

}  // namespace sepcal
