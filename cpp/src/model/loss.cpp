// SPDX-License-Identifier: BSD-3-Clause
#include "model/loss.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace sepcal::model {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// 95 % efficient under normal noise: Huber & Ronchetti, Table 4.1; Holland & Welsch (1977).
constexpr double huber_width = 1.345;
constexpr double cauchy_width = 2.385;

/// E min(|v|, c)^2 of a standard normal v.
double expected_square(double c) {
  const double outside = std::erfc(c / std::numbers::sqrt2);  // P(|v| > c)
  const double density = std::exp(-0.5 * c * c) / std::sqrt(2.0 * std::numbers::pi);
  return 1.0 - outside - 2.0 * c * density + c * c * outside;
}

}  // namespace

RobustLoss::RobustLoss(Loss loss, double width)
    : loss_(loss),
      width_(width > 0             ? width
             : loss == Loss::huber ? huber_width
                                   : cauchy_width) {}

double RobustLoss::cost(double s) const {
  const double size = std::abs(s);
  if (loss_ == Loss::huber) {
    return size <= width_ ? s * s : width_ * (2.0 * size - width_);
  }
  const double u = s / width_;
  return width_ * width_ * std::log1p(u * u);
}

double RobustLoss::weight(double s) const {
  if (loss_ == Loss::huber) return std::abs(s) <= width_ ? 1.0 : width_ / std::abs(s);
  const double u = s / width_;
  return 1.0 / (1.0 + u * u);
}

double RobustLoss::slope(double s) const {
  if (loss_ == Loss::huber) return std::abs(s) <= width_ ? 1.0 : 0.0;
  const double u = s / width_;
  const double w = weight(s);
  return (1.0 - u * u) * w * w;
}

double RobustLoss::scale(const Eigen::Ref<const VectorXd>& residual) const {
  const double c = loss_ == Loss::huber ? width_ : huber_width;
  VectorXd squares = residual.cwiseAbs2();
  std::ranges::sort(squares);
  const double wanted = static_cast<double>(squares.size()) * expected_square(c);
  // With the m smallest inside, sigma^2 = (their sum) / (wanted - c^2 (N - m)): right where it puts
  // just these inside. The left-hand side falls with sigma, so that there is one such m.
  VectorXd sums(squares.size());
  std::partial_sum(squares.begin(), squares.end(), sums.begin());
  for (Index m = squares.size(); m > 0; --m) {
    const double left = wanted - c * c * static_cast<double>(squares.size() - m);
    if (!(left > 0.0)) return 0.0;
    const double variance = sums[m - 1] / left;
    if (squares[m - 1] <= c * c * variance) return std::sqrt(variance);
  }
  return 0.0;
}

}  // namespace sepcal::model
