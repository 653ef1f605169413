// SPDX-License-Identifier: BSD-3-Clause
#include "base/gaps.hpp"

#include <algorithm>

#include "sepcal/quantity.hpp"

namespace sepcal::base {

double find_gap(std::vector<double> intervals) {
  constexpr double jump = 5 * (1 + 1e-6);
  if (intervals.empty()) return infinity;
  std::ranges::sort(intervals);
  const std::size_t n = intervals.size();
  const double longest = intervals[static_cast<std::size_t>(0.95 * static_cast<double>(n - 1))];
  double usual = (intervals[(n - 1) / 2] + intervals[n / 2]) / 2;
  constexpr std::size_t fewest = 20;  // of which one in twenty can be told
  while (n >= fewest) {
    const double reached = std::min(jump * usual, longest);
    const double next = *std::prev(std::ranges::upper_bound(intervals, std::max(usual, reached)));
    if (!(next > usual)) break;
    usual = next;
  }
  return jump * usual;
}

}  // namespace sepcal::base
