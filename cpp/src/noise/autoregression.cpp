// SPDX-License-Identifier: BSD-3-Clause
// Row t of a block is predicted from its min(t, p) predecessors, with variance
// sigma^2 / prod_{t<j<=p} (1 - r_j^2): the exact Gaussian likelihood of an AR(p).
#include "noise/autoregression.hpp"

#include <algorithm>
#include <cmath>

namespace sepcal::noise {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd phi_from_partial(const VectorXd& partial) {
  VectorXd phi = partial;
  for (Index k = 1; k < phi.size(); ++k) {
    const VectorXd before = phi.head(k);
    phi.head(k) -= partial[k] * before.reverse();
  }
  return phi;
}

VectorXd partial_from_phi(VectorXd phi) {
  for (Index k = phi.size() - 1; k > 0; --k) {
    const VectorXd now = phi.head(k);
    phi.head(k) = (now + phi[k] * now.reverse()) / (1.0 - phi[k] * phi[k]);
  }
  return phi;
}

bool is_stationary(const VectorXd& phi) {
  return (partial_from_phi(phi).array().abs() < 1.0).all();
}

BurgFit fit_burg(const VectorXd& y, const std::vector<Index>& lengths, int max_order) {
  BurgFit fit{VectorXd::Zero(max_order + 1), VectorXd::Zero(max_order + 1),
              VectorXd::Zero(max_order)};
  VectorXd forward = y;
  VectorXd backward = y;
  const auto rows = static_cast<double>(y.size());
  // The first rows of the blocks, each divided by its own variance ratio, and their log variances.
  double early = 0.0;
  double log_ratio = 0.0;
  for (int order = 0;; ++order) {
    double later = 0.0;
    double starts = 0.0;
    double cross = 0.0;
    double power = 0.0;
    double early_rows = 0.0;
    Index first = 0;
    for (const Index length : lengths) {
      const Index rest = length - order;
      early_rows += static_cast<double>(std::min<Index>(length, order + 1));
      if (rest > 0) {
        const auto f = forward.segment(first + order, rest);
        later += f.squaredNorm();
        starts += f[0] * f[0];
        if (rest > 1) {
          const auto b = backward.segment(first + order, rest - 1);
          cross += f.tail(rest - 1).dot(b);
          power += f.tail(rest - 1).squaredNorm() + b.squaredNorm();
        }
      }
      first += length;
    }
    const double square = later + early;
    fit.criterion[order] = rows * std::log(square / rows) + log_ratio;
    fit.log_ratio[order] = log_ratio;
    if (order == max_order) return fit;
    const double r = power > 0.0 ? 2.0 * cross / power : 0.0;
    const double left = 1.0 - r * r;
    if (!(left > 1e-10)) {  // predicted without error: no higher order has anything to add
      fit.criterion.tail(max_order - order).setConstant(fit.criterion[order]);
      fit.log_ratio.tail(max_order - order).setConstant(log_ratio);
      return fit;
    }
    fit.partial[order] = r;
    early = (early + starts) * left;
    log_ratio -= early_rows * std::log(left);
    first = 0;
    for (const Index length : lengths) {
      for (Index t = first + length - 1; t > first + order; --t) {
        const double f = forward[t];
        forward[t] = f - r * backward[t - 1];
        backward[t] = backward[t - 1] - r * f;
      }
      first += length;
    }
  }
}

}  // namespace sepcal::noise
