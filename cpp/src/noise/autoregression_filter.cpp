// SPDX-License-Identifier: BSD-3-Clause
#include "noise/autoregression_filter.hpp"

#include <algorithm>
#include <cmath>

#include "noise/autoregression.hpp"

namespace sepcal::noise {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

namespace {

/// prod_{t<j<=p} (1 - r_j^2) for t = 0, ..., p.
VectorXd variance_ratios(const VectorXd& partial) {
  VectorXd ratios = VectorXd::Ones(partial.size() + 1);
  for (Index t = partial.size() - 1; t >= 0; --t) {
    ratios[t] = ratios[t + 1] * (1.0 - partial[t] * partial[t]);
  }
  return ratios;
}

}  // namespace

void whiten_autoregression(const VectorXd& partial, Ref<VectorXd> x) {
  const Index p = std::min(partial.size(), x.size());
  if (partial.size() == 0) return;
  const VectorXd ratios = variance_ratios(partial);
  VectorXd first = x.head(p);
  VectorXd backward = first;
  for (Index order = 0; order < p; ++order) {
    const double r = partial[order];
    for (Index t = p - 1; t > order; --t) {
      const double f = first[t];
      first[t] = f - r * backward[t - 1];
      backward[t] = backward[t - 1] - r * f;
    }
  }
  if (x.size() > p) subtract_predictions(phi_from_partial(partial), x);
  for (Index t = 0; t < p; ++t) x[t] = first[t] * std::sqrt(ratios[t]);
}

void whiten_autoregression_backwards(const VectorXd& partial, Ref<VectorXd> x) {
  const Index p = std::min(partial.size(), x.size());
  if (p == 0) return;
  MatrixXd of_first = MatrixXd::Identity(p, p);  // W of the first rows
  for (auto column : of_first.colwise()) whiten_autoregression(partial, column);
  const VectorXd first = x.head(p);
  x.head(p).setZero();
  if (x.size() > p) {  // later rows take from those before as earlier ones take from those behind
    const VectorXd phi = phi_from_partial(partial);
    x.reverseInPlace();
    VectorXd last = x.head(p);
    for (Index t = p - 1; t > 0; --t) last[t] -= phi.head(t).dot(x.head(t).reverse());
    subtract_predictions(phi, x);
    x.head(p) = last;
    x.reverseInPlace();
  }
  x.head(p) += of_first.transpose() * first;
}

void colour_autoregression(const VectorXd& partial, Ref<VectorXd> w) {
  if (partial.size() == 0) return;
  const VectorXd ratios = variance_ratios(partial);
  VectorXd phi;
  for (Index t = 0; t < w.size(); ++t) {
    const Index order = std::min(t, partial.size());
    if (order > phi.size()) phi = phi_from_partial(partial.head(order));
    w[t] /= std::sqrt(ratios[order]);
    if (order > 0) w[t] += phi.dot(w.segment(t - order, order).reverse());
  }
}

}  // namespace sepcal::noise
