// SPDX-License-Identifier: BSD-3-Clause
#include "fractional_difference.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sepcal {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::VectorXd;

constexpr Index near_rows = 16;
// Trapezoids in ln(lambda) converge like e^{-pi^2 / step}: 2e-11 here.
constexpr double step = 0.4;

}  // namespace

FractionalDifference::FractionalDifference(double d, Index rows)
    : d_(d < 0.0 ? d + 1.0 : d), summed_(d < 0.0) {
  if (d_ <= 0.0) return;
  near_.resize(std::max<Index>(1, std::min(rows, near_rows)));
  near_[0] = 1.0;
  for (Index k = 1; k < near_.size(); ++k) {
    near_[k] = near_[k - 1] * (static_cast<double>(k - 1) - d_) / static_cast<double>(k);
  }
  if (rows <= near_rows) return;
  constexpr double pi = std::numbers::pi;
  const double scale = std::sin(pi * d_) / pi;
  // What lies below `lowest` adds less than 1e-10 over all rows; above `highest`, e^{-45}.
  const double lowest = std::log(1e-10 / static_cast<double>(rows) / scale) / (1.0 + d_);
  const double highest = std::log(45.0 / (static_cast<double>(near_rows) - d_));
  const auto nodes = static_cast<Index>(std::ceil((highest - lowest) / step)) + 1;
  const ArrayXd lambda = ArrayXd::NullaryExpr(
      nodes, [&](Index i) { return std::exp(lowest + step * static_cast<double>(i)); });
  decay_ = (-lambda).exp();
  weight_ = -scale * step * lambda * lambda.unaryExpr([this](double x) {
    return std::pow(-std::expm1(-x), d_);
  }) * (-(static_cast<double>(near_rows) - d_) * lambda).exp();
}

void FractionalDifference::apply(Eigen::Ref<VectorXd> x) const {
  if (d_ > 0.0) {
    const Index span = near_.size();
    ArrayXd state = ArrayXd::Zero(decay_.size());
    // A ring of the last rows as they were, doubled so that any `span` of them are contiguous.
    VectorXd past = VectorXd::Zero(2 * span);
    const VectorXd reversed = near_.reverse();
    Index at = 0;
    for (double& value : x) {
      if (decay_.size() > 0) state = decay_ * state + past[at];  // the row that leaves the ring
      past[at] = past[at + span] = value;
      at = at + 1 == span ? 0 : at + 1;
      value = reversed.dot(past.segment(at, span));
      if (decay_.size() > 0) value += (weight_ * state).sum();
    }
  }
  if (!summed_) return;
  double sum = 0.0;
  for (double& value : x) value = sum += value;
}

}  // namespace sepcal
