// SPDX-License-Identifier: BSD-3-Clause
// With phi(B) x = u, cross c and autocovariance gamma obey, phi running over its lags i,
//   c(k) = gamma_u(k) + sum phi_i c(k + i)      backwards from where u hardly changes,
//   gamma(k) = c(k) + sum phi_i gamma(|k - i|)  as Yule & Walker for k <= p, then forwards.
#include "noise/noise_autocovariance.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/decompositions.hpp"

namespace sepcal::noise {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double fractional_variance(double delta) {
  // Not lgamma: it writes a global sign.
  return std::tgamma(1.0 - 2.0 * delta) / std::pow(std::tgamma(1.0 - delta), 2);
}

namespace {

/// Rows over which the recursion forgets where it began: until the response of phi to a single row
/// is lost in rounding.
Index rows_to_forget(const VectorXd& phi) {
  constexpr Index most = 2048;
  constexpr double lost = 1e-18;
  const Index order = phi.size();
  const VectorXd reversed = phi.reverse();
  VectorXd response = VectorXd::Zero(most + order);
  response[order - 1] = 1.0;
  Index small = 0;  // rows in a row
  for (Index row = 0; row < most; ++row) {
    const double value = reversed.dot(response.segment(row, order));
    response[row + order] = value;
    small = std::abs(value) < lost ? small + 1 : 0;
    if (small == order) return row + 1;
  }
  return most;
}

}  // namespace

NoiseMoments find_moments(double delta, const VectorXd& phi, Index lags) {
  const Index order = phi.size();
  const Index last = std::max(lags, order) + (order > 0 ? rows_to_forget(phi) + order : 0);
  VectorXd gamma(last + 1);
  gamma[0] = fractional_variance(delta);
  for (Index k = 0; k < last; ++k) {
    const auto at = static_cast<double>(k);
    gamma[k + 1] = gamma[k] * (at + delta) / (at + 1.0 - delta);
  }
  if (order == 0) return {gamma, gamma};

  VectorXd cross = gamma;
  cross.tail(order) /= 1.0 - phi.sum();
  for (Index k = last - order; k >= 0; --k) cross[k] += phi.dot(cross.segment(k + 1, order));

  MatrixXd equations = MatrixXd::Identity(order + 1, order + 1);
  for (Index k = 0; k <= order; ++k) {
    for (Index i = 1; i <= order; ++i) equations(k, std::abs(k - i)) -= phi[i - 1];
  }
  const Index most = std::max(lags, order);
  gamma.conservativeResize(most + 1);
  gamma.head(order + 1) = equations.partialPivLu().solve(cross.head(order + 1));
  for (Index k = order + 1; k <= most; ++k) {
    gamma[k] = cross[k] + phi.dot(gamma.segment(k - order, order).reverse());
  }
  return {gamma.head(most + 1), cross.head(most + 1)};
}

}  // namespace sepcal::noise
