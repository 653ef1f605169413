// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/order_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

namespace sepcal::numerics {
namespace {

/// Where a quantile lies among `size` values: `part` of the way from the one at `below` to the
/// next.
struct Place {
  std::size_t below;
  double part;
};

Place find_place(std::size_t size, double share) {
  const double at = share * static_cast<double>(size - 1);
  return {static_cast<std::size_t>(at), at - std::floor(at)};
}

}  // namespace

double quantile(std::span<const double> values, double share) {
  const auto [below, part] = find_place(values.size(), share);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return std::lerp(values[below], values[above], part);
}

double select_quantile(std::vector<double>& values, double share) {
  const auto [below, part] = find_place(values.size(), share);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(below);
  std::ranges::nth_element(values, at);
  const auto next = std::next(at);
  return std::lerp(*at, next == values.end() ? *at : *std::min_element(next, values.end()), part);
}

double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace sepcal::numerics
