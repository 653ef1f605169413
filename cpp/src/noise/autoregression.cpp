// SPDX-License-Identifier: BSD-3-Clause
// Row t of a block is predicted from its min(t, p) predecessors, with variance
// sigma^2 / prod_{t<j<=p} (1 - r_j^2): the exact Gaussian likelihood of an AR(p).
#include "noise/autoregression.hpp"

#include <algorithm>
#include <cmath>

#include "noise/lanes.hpp"

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

namespace {

/// Of pairs of rows, a forward one and the backward one before it.
struct PairSums {
  double product = 0.0;
  double squares = 0.0;  // of both
  double forward = 0.0;  // the forward ones' squares
};

// NOLINTBEGIN(*-pointer-arithmetic,*-constant-array-index): lanes of a register.

double add_lanes(const Lanes& sum) {
  return ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7]));
}

SEPCAL_EVERY_WIDTH PairSums add_pairs(const double* forward, const double* backward, Index pairs) {
  Lanes product = {};
  Lanes forwards = {};
  Lanes backwards = {};
  Index t = 0;
  for (; t + lane_count <= pairs; t += lane_count) {
    Lanes f;
    Lanes b;
    load(forward + t, f);
    load(backward + t, b);
    product += f * b;
    forwards += f * f;
    backwards += b * b;
  }
  PairSums sums{add_lanes(product), add_lanes(backwards), add_lanes(forwards)};
  for (; t < pairs; ++t) {
    sums.product += forward[t] * backward[t];
    sums.forward += forward[t] * forward[t];
    sums.squares += backward[t] * backward[t];
  }
  sums.squares += sums.forward;
  return sums;
}

/// Both become what the other of a pair does not predict.
SEPCAL_EVERY_WIDTH void reflect(double r, double* forward, double* backward, Index pairs) {
  Index t = 0;
  for (; t + lane_count <= pairs; t += lane_count) {
    Lanes f;
    Lanes b;
    load(forward + t, f);
    load(backward + t, b);
    const Lanes left = f - r * b;
    const Lanes right = b - r * f;
    store(left, forward + t);
    store(right, backward + t);
  }
  for (; t < pairs; ++t) {
    const double f = forward[t];
    forward[t] = f - r * backward[t];
    backward[t] = backward[t] - r * f;
  }
}

// NOLINTEND(*-pointer-arithmetic,*-constant-array-index)

}  // namespace

BurgFit fit_burg(const VectorXd& y, const std::vector<Index>& lengths, int max_order) {
  BurgFit fit{VectorXd::Zero(max_order + 1), VectorXd::Zero(max_order + 1),
              VectorXd::Zero(max_order)};
  VectorXd forward = y;
  VectorXd backward = y;  // a row stands `order` rows before its own, that of its pair
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
        const Index start = first + order;
        const PairSums sums = add_pairs(&forward[start] + 1, &backward[first], rest - 1);
        starts += forward[start] * forward[start];
        later += forward[start] * forward[start] + sums.forward;
        cross += sums.product;
        power += sums.squares;
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
      const Index pairs = length - order - 1;
      if (pairs > 0) reflect(r, &forward[first + order] + 1, &backward[first], pairs);
      first += length;
    }
  }
}

}  // namespace sepcal::noise
