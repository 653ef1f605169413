// SPDX-License-Identifier: BSD-3-Clause
// Windows in which something may come and go: the whole record, its halves and quarters, each half
// over the next.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sepcal::diagnosis {

inline constexpr Eigen::Index window_steps = 8;  // of the record: where windows begin and end

/// From one step to another, [first, last) of window_steps.
struct Window {
  Eigen::Index first = 0;
  Eigen::Index last = window_steps;

  bool is_whole() const { return last - first == window_steps; }
};

/// The row that a step begins with.
inline Eigen::Index row_of(Eigen::Index step, Eigen::Index rows) {
  return step * rows / window_steps;
}

inline std::vector<Window> nested_windows() {
  std::vector<Window> windows;
  for (Eigen::Index length = window_steps; length > 1; length /= 2) {
    for (Eigen::Index first = 0; first + length <= window_steps; first += length / 2) {
      windows.push_back({first, first + length});
    }
  }
  return windows;
}

}  // namespace sepcal::diagnosis
