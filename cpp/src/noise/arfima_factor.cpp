// SPDX-License-Identifier: BSD-3-Clause
#include "noise/arfima_factor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "noise/autoregression.hpp"
#include "noise/noise_autocovariance.hpp"
#include "numerics/decompositions.hpp"

namespace sepcal::noise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

Index longest(const std::vector<Index>& lengths) {
  return lengths.empty() ? 0 : *std::ranges::max_element(lengths);
}

}  // namespace

ArfimaFactor::ArfimaFactor(double delta, VectorXd phi, const std::vector<Index>& lengths)
    : delta_(delta), phi_(std::move(phi)), difference_(delta, longest(lengths)) {
  const Index order = phi_.size();
  const Index rows = longest(lengths);
  for (const Index length : lengths) log_variance_[std::max<Index>(0, length - order)] = 0.0;
  if (delta != 0.0 && rows > 0) {
    constexpr Index at_once = 16;  // variances, none above 20, under one logarithm
    gain_ = VectorXd::Ones(rows);
    precision_ = VectorXd::Ones(rows);
    double variance = fractional_variance(delta);
    double product = 1.0;
    double log_variance = 0.0;
    auto asked = log_variance_.upper_bound(0);
    for (Index s = 0; s < rows; ++s) {
      const auto at = static_cast<double>(s);
      if (s > 0) {
        gain_[s] = gain_[s - 1] * (1.0 - delta / at);  // no division waits for another
        const double partial = delta / (at - delta);
        variance *= (1.0 - partial) * (1.0 + partial);
      }
      precision_[s] = 1.0 / (gain_[s] * std::sqrt(variance));
      product *= variance;
      const bool is_asked = asked != log_variance_.end() && asked->first == s + 1;
      if (s % at_once != 0 && !is_asked) continue;
      log_variance += std::log(product);
      product = 1.0;
      if (!is_asked) continue;
      asked->second = log_variance;
      ++asked;
    }
  }
  if (order == 0) return;
  constexpr Index most_regressed = 1024;
  // x at row i < p and u at row p + s are p + s - i rows apart.
  const Index regressed = delta == 0.0 ? 0 : std::clamp<Index>(rows - order, 0, most_regressed);
  const NoiseMoments moments = find_moments(delta, phi_, order + regressed);
  regression_.resize(order, regressed);
  for (Index i = 0; i < order && regressed > 0; ++i) {
    VectorXd row = moments.cross.segment(order - i, regressed);
    whiten_fractional(row);
    regression_.row(i) = row;
  }
  MatrixXd covariance(order, order);
  for (Index i = 0; i < order; ++i) {
    for (Index j = 0; j < order; ++j) covariance(i, j) = moments.autocovariance[std::abs(i - j)];
  }
  for (const Index length : lengths) {
    if (length == 0 || heads_.contains(length)) continue;
    const Index head = std::min(order, length);
    const Index later = std::min(length - head, regressed);
    MatrixXd given = covariance.topLeftCorner(head, head);
    const auto on_later = regression_.leftCols(later);
    if (later > 0) given -= on_later * on_later.transpose();
    const Eigen::LLT<MatrixXd> cholesky(given);
    MatrixXd factor = cholesky.matrixL();
    if (cholesky.info() != Eigen::Success) {
      factor.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    heads_[length] = {factor, 2.0 * factor.diagonal().array().log().sum()};
  }
}

double ArfimaFactor::log_determinant(Index rows) const {
  const double later = log_variance_.at(std::max<Index>(0, rows - phi_.size()));
  return phi_.size() == 0 || rows == 0 ? later : heads_.at(rows).log_determinant + later;
}

double ArfimaFactor::log_determinant(const std::vector<Index>& blocks) const {
  double sum = 0.0;
  for (const Index block : blocks) sum += log_determinant(block);
  return sum;
}

void ArfimaFactor::whiten(Ref<VectorXd> x, const std::vector<Index>& blocks) const {
  Index first = 0;
  for (const Index block : blocks) {
    whiten(x.segment(first, block));
    first += block;
  }
}

void ArfimaFactor::whiten_fractional(Ref<VectorXd> u) const {
  if (delta_ == 0.0) return;
  u.array() *= gain_.head(u.size()).array();
  difference_.apply(u);
  u.array() *= precision_.head(u.size()).array();
}

void ArfimaFactor::colour_fractional(Ref<VectorXd> u) const {
  if (delta_ == 0.0) return;
  u.array() /= precision_.head(u.size()).array();
  if (delta_ > -1.0) {
    // (1 - B)^-delta is itself a difference where delta <= 0, else the sum of one.
    FractionalDifference(delta_ > 0.0 ? 1.0 - delta_ : -delta_, u.size()).apply(u);
    double sum = 0.0;
    if (delta_ > 0.0) {
      for (double& value : u) value = sum += value;
    }
  } else {  // the inverse of a running sum
    for (Index t = u.size() - 1; t > 0; --t) u[t] -= u[t - 1];
  }
  u.array() /= gain_.head(u.size()).array();
}

void ArfimaFactor::whiten(Ref<VectorXd> x) const {
  const Index order = phi_.size();
  if (order == 0) {
    whiten_fractional(x);
    return;
  }
  if (x.size() == 0) return;
  const Index head = std::min(order, x.size());
  subtract_predictions(phi_, x);
  auto tail = x.tail(x.size() - head);
  whiten_fractional(tail);
  auto first = x.head(head);
  const Index later = std::min(tail.size(), regression_.cols());
  if (later > 0) first -= regression_.leftCols(later) * tail.head(later);
  heads_.at(x.size()).factor.triangularView<Eigen::Lower>().solveInPlace(first);
}

void ArfimaFactor::whiten_backwards(Ref<VectorXd> x) const {
  if (delta_ == 0.0) return;
  x.array() *= precision_.head(x.size()).array();
  x.reverseInPlace();
  difference_.apply(x);
  x.reverseInPlace();
  x.array() *= gain_.head(x.size()).array();
}

void ArfimaFactor::colour(Ref<VectorXd> x) const {
  const Index order = phi_.size();
  if (order == 0) {
    colour_fractional(x);
    return;
  }
  if (x.size() == 0) return;
  const Index head = std::min(order, x.size());
  auto tail = x.tail(x.size() - head);
  auto first = x.head(head);
  first = (heads_.at(x.size()).factor.triangularView<Eigen::Lower>() * first).eval();
  const Index later = std::min(tail.size(), regression_.cols());
  if (later > 0) first += regression_.leftCols(later) * tail.head(later);
  colour_fractional(tail);
  const VectorXd reversed = phi_.reverse();
  for (Index t = order; t < x.size(); ++t) x[t] += reversed.dot(x.segment(t - order, order));
}

}  // namespace sepcal::noise
