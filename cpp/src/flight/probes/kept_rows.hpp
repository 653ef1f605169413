// SPDX-License-Identifier: BSD-3-Clause
// The rows of a flight that are kept, as stretches: their memory grows with the gaps, not with the
// rows. Of a flight whose columns are mapped, the pages of rows that were visited may go.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "base/excerpt.hpp"

namespace sepcal::probes {

class KeptRows {
 public:
  using Release = std::function<void(std::size_t first, std::size_t last)>;

  /// Rows [0, count). `release` may be empty.
  explicit KeptRows(std::size_t count, Release release = {}) : release_(std::move(release)) {
    if (count > 0) stretches_.emplace_back(0, count);
  }

  std::size_t size() const {
    std::size_t rows = 0;
    for (const auto& [first, last] : stretches_) rows += last - first;
    return rows;
  }
  bool empty() const { return stretches_.empty(); }

  /// The first row that fails the test.
  template <class Test>
  std::optional<std::size_t> find_if_not(const Test& test) const {
    std::optional<std::size_t> found;
    walk([&](std::size_t row) {
      if (test(row)) return true;
      found = row;
      return false;
    });
    return found;
  }

  template <class Visit>
  void for_each(const Visit& visit) const {
    walk([&](std::size_t row) {
      visit(row);
      return true;
    });
  }

  /// Drops the rows that fail the test.
  template <class Test>
  void keep_if(const Test& test) {
    std::vector<std::pair<std::size_t, std::size_t>> kept;
    for_each([&](std::size_t row) {
      if (!test(row)) return;
      if (kept.empty() || kept.back().second != row) kept.emplace_back(row, row);
      kept.back().second = row + 1;
    });
    stretches_ = std::move(kept);
  }

  /// The row that `index` kept ones precede.
  std::size_t at(std::size_t index) const {
    for (const auto& [first, last] : stretches_) {
      if (index < last - first) return first + index;
      index -= last - first;
    }
    return 0;
  }

  std::vector<std::size_t> list() const {
    std::vector<std::size_t> rows;
    rows.reserve(size());
    for_each([&](std::size_t row) { rows.push_back(row); });
    return rows;
  }

 private:
  /// In pieces, until `visit(row)` is false.
  template <class Visit>
  void walk(const Visit& visit) const {
    for (const auto& [begin, end] : stretches_) {
      for (std::size_t first = begin; first < end; first += base::piece_rows) {
        const std::size_t last = std::min(first + base::piece_rows, end);
        for (std::size_t row = first; row < last; ++row) {
          if (!visit(row)) return;
        }
        if (release_) release_(first, last);
      }
    }
  }

  std::vector<std::pair<std::size_t, std::size_t>> stretches_;  // [first, last) each
  Release release_;
};

}  // namespace sepcal::probes
