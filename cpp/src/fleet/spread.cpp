// SPDX-License-Identifier: BSD-3-Clause
#include "fleet/spread.hpp"

#include <algorithm>
#include <cmath>

namespace sepcal::fleet {

Spread find_spread(const std::vector<double>& estimates, const std::vector<double>& variances) {
  constexpr int most_steps = 200;
  Spread spread;
  for (const double v : variances) spread.variance += v / static_cast<double>(variances.size());
  for (int step = 0; step < most_steps; ++step) {
    double w1 = 0.0;  // sums of powers of the weights
    double w2 = 0.0;
    double w3 = 0.0;
    double wy = 0.0;
    for (std::size_t i = 0; i < estimates.size(); ++i) {
      const double w = 1.0 / (variances[i] + spread.variance);
      w1 += w;
      w2 += w * w;
      w3 += w * w * w;
      wy += w * estimates[i];
    }
    spread.mean = wy / w1;
    spread.standard_error = std::sqrt(1.0 / w1);
    double square = 0.0;
    for (std::size_t i = 0; i < estimates.size(); ++i) {
      const double w = 1.0 / (variances[i] + spread.variance);
      const double d = estimates[i] - spread.mean;
      square += w * w * d * d;
    }
    const double score = 0.5 * (square - w1 + w2 / w1);
    const double information = 0.5 * (w2 - 2.0 * w3 / w1 + (w2 / w1) * (w2 / w1));
    const double next = std::max(0.0, spread.variance + score / information);
    const double change = std::abs(next - spread.variance);
    spread.variance = next;
    if (change * w1 < 1e-12 * static_cast<double>(estimates.size())) break;
  }
  return spread;
}

}  // namespace sepcal::fleet
