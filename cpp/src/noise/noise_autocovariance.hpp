// SPDX-License-Identifier: BSD-3-Clause
// Second moments of x with phi(B) x = u, (1 - B)^delta u = w, w white of variance 1, for
// -1 <= delta < 0.5: u has gamma_0 = G(1-2 delta) / G(1-delta)^2 (G the gamma function) and
// gamma_{k+1} = gamma_k (k + delta) / (k + 1 - delta)  (Hosking 1981).
#pragma once

#include <Eigen/Core>

namespace sepcal::noise {

/// gamma_0 of u.
double fractional_variance(double delta);

struct NoiseMoments {
  Eigen::VectorXd autocovariance;  // of x at lags 0, ..., lags
  Eigen::VectorXd cross;           // of x_t and u_{t+k}, k = 0, ..., lags
};

NoiseMoments find_moments(double delta, const Eigen::VectorXd& phi, Eigen::Index lags);

}  // namespace sepcal::noise
