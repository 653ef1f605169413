// SPDX-License-Identifier: BSD-3-Clause
// Records for profile likelihoods, the quantiles that end their intervals, crossings by bisection.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "sepcal/options.hpp"
#include "simulated_records.hpp"

namespace sepcal::test {

inline constexpr double z_95 = 1.959963984540054;    // SciPy
inline constexpr double t_95_8 = 2.306004135204166;  // 8 degrees of freedom

inline FitOptions white() {
  FitOptions options;
  options.samples = 50;
  options.coloured_errors = false;
  return options;
}

/// Ten samples of a line, with noise that is anything but small.
inline Record line_record() {
  Draws draws(3);
  const std::vector<double> u = draws.uniform_column(10, -1, 2);
  std::vector<double> z;
  for (const double x : u) z.push_back(0.7 * x - 0.2 + 0.5 * draws.normal());
  Record record;
  record.add("u", u).add("z", z);
  return record;
}

inline Record growth_record(double noise) {
  Draws draws(5);
  const std::vector<double> u = draws.uniform_column(10, 0, 2);
  std::vector<double> z;
  for (const double x : u) z.push_back(std::exp(0.6 * x) + noise * draws.normal());
  Record record;
  record.add("u", u).add("z", z);
  return record;
}

/// Where a function that rises away from `inside` crosses `height`, between the two.
inline double cross(const std::function<double(double)>& f, double height, double inside,
                    double outside) {
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (inside + outside);
    (f(middle) < height ? inside : outside) = middle;
  }
  return inside;
}

}  // namespace sepcal::test
