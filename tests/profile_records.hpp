// SPDX-License-Identifier: BSD-3-Clause
// A line's record for profile likelihoods, and the quantiles that end their intervals.
#pragma once

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

}  // namespace sepcal::test
