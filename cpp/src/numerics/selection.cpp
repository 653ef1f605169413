// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/selection.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sepcal::numerics {

double share_after_selection(double size, double least) {
  constexpr double reach = 8.0;  // standard errors to either side of what was estimated
  constexpr double step = 0.02;
  constexpr double beyond = 6.0;  // where the choice says nothing
  if (!(size < least + beyond)) return 1.0;
  const auto normal_tail = [](double x) { return 0.5 * std::erfc(x / std::numbers::sqrt2); };
  double sum = 0.0;
  double moment = 0.0;
  for (int i = 0; i * step <= 2.0 * reach; ++i) {
    const double truth = size - reach + i * step;
    const double told = normal_tail(least - truth) + normal_tail(least + truth);
    const double likelihood = std::exp(-0.5 * (size - truth) * (size - truth)) / told;
    sum += likelihood;
    moment += truth * likelihood;
  }
  return std::clamp(0.5 + 0.5 * moment / sum / size, 0.0, 1.0);
}

}  // namespace sepcal::numerics
