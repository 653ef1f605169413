// SPDX-License-Identifier: BSD-3-Clause
// The natural cubic spline through given values at evenly spaced knots, for the simulators: second
// derivatives from their tridiagonal system, zero at both ends, straight lines beyond.
#pragma once

#include <vector>

namespace sepcal::simulation {

class HiddenSpline {
 public:
  /// `values` at knots spaced evenly from `first` to `last` > first; three or more.
  HiddenSpline(double first, double last, std::vector<double> values);

  double operator()(double x) const;

 private:
  double first_;
  double spacing_;
  std::vector<double> values_;     // at the knots
  std::vector<double> curvature_;  // second derivatives at the knots
};

}  // namespace sepcal::simulation
