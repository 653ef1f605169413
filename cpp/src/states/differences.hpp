// SPDX-License-Identifier: BSD-3-Clause
// Derivatives by central differences along a record, exact to fourth order.
#pragma once

#include <array>
#include <cmath>
#include <span>

namespace sepcal::states {

/// f' = sum weight f(x + node h) / h.
struct DifferenceNode {
  double node;
  double weight;
};
inline constexpr std::array<DifferenceNode, 4> difference_nodes{
    {{-2.0, 1.0 / 12.0}, {-1.0, -8.0 / 12.0}, {1.0, 8.0 / 12.0}, {2.0, -1.0 / 12.0}}};

/// The step h that moves an input, of its rms: of one that is zero unless driven, of its unit.
inline constexpr double share_of_input = 1e-4;

/// Of the values that are finite.
inline double rms(std::span<const double> values) {
  double sum = 0.0;
  double count = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value * value;
    count += 1.0;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

}  // namespace sepcal::states
