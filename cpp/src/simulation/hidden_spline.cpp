// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/hidden_spline.hpp"

#include <algorithm>
#include <cmath>

namespace sepcal::simulation {

HiddenSpline::HiddenSpline(double first, double last, std::vector<double> values)
    : first_(first),
      spacing_((last - first) / static_cast<double>(values.size() - 1)),
      values_(std::move(values)),
      curvature_(values_.size(), 0.0) {
  // m[i-1] + 4 m[i] + m[i+1] = 6 (y[i-1] - 2 y[i] + y[i+1]) / h^2, by elimination and back.
  const std::size_t last_knot = values_.size() - 1;
  std::vector<double> above(values_.size(), 0.0);
  for (std::size_t i = 1; i < last_knot; ++i) {
    const double bend = values_[i - 1] - 2.0 * values_[i] + values_[i + 1];
    const double pivot = 4.0 - above[i - 1];
    above[i] = 1.0 / pivot;
    curvature_[i] = (6.0 * bend / (spacing_ * spacing_) - curvature_[i - 1]) / pivot;
  }
  for (std::size_t i = last_knot - 1; i > 0; --i) curvature_[i] -= above[i] * curvature_[i + 1];
}

double HiddenSpline::operator()(double x) const {
  const double position = (x - first_) / spacing_;
  const auto intervals = static_cast<double>(values_.size() - 1);
  const double left = std::clamp(std::floor(position), 0.0, intervals - 1.0);
  const auto i = static_cast<std::size_t>(left);
  const double h = spacing_;
  const double slope = (values_[i + 1] - values_[i]) / h;
  if (position < 0.0) {
    return values_[i] + (x - first_) * (slope - h * curvature_[i + 1] / 6.0);
  }
  if (position > intervals) {
    return values_[i + 1] + (position - intervals) * h * (slope + h * curvature_[i] / 6.0);
  }
  const double b = position - left;
  const double a = 1.0 - b;
  return a * values_[i] + b * values_[i + 1] +
         h * h / 6.0 * ((a * a * a - a) * curvature_[i] + (b * b * b - b) * curvature_[i + 1]);
}

}  // namespace sepcal::simulation
