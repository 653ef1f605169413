// SPDX-License-Identifier: BSD-3-Clause
// Covariances that depend on the lag alone, by the fast Fourier transform.
#pragma once

#include "sepcal/detail/eigen.hpp"

namespace sepcal::numerics {

/// S X for the symmetric Toeplitz matrix S whose first column is `lags` (X.rows() or more).
Eigen::MatrixXd multiply_toeplitz(const Eigen::VectorXd& lags,
                                  const Eigen::Ref<const Eigen::MatrixXd>& X);

/// sum_t x_t x_{t + lag} / N at lags 0, ..., `furthest` < N, of x (N) as it stands.
Eigen::VectorXd autocovariance(const Eigen::VectorXd& x, Eigen::Index furthest);

}  // namespace sepcal::numerics
