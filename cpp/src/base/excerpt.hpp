// SPDX-License-Identifier: BSD-3-Clause
// A constant number of rows of a long record, for what needs rows all at once, and passes over a
// record that is mapped from a file.
#pragma once

#include <algorithm>
#include <cstddef>

#include "sepcal/record.hpp"

namespace sepcal::base {

/// Rows of an excerpt: as many as the noise of a residual can be told from, in stretches that are
/// long beside what it remembers.
inline constexpr std::size_t excerpt_rows = 100'000;
inline constexpr std::size_t excerpt_stretches = 10;

/// The record, where it is not mapped or has no more than excerpt_rows; else stretches of it,
/// evenly spread over its segments' rows and together as long.
Record excerpt(const Record& record);

inline constexpr std::size_t piece_rows = 16'384;

/// visit(first, last) for rows of the segments, a piece at a time; where the record is mapped, a
/// piece's pages go before the next one is visited.
template <class Visit>
void for_each_piece(const Record& record, const Visit& visit) {
  for (const Segment& segment : record.segments()) {
    for (std::size_t first = segment.first; first < segment.last; first += piece_rows) {
      const std::size_t last = std::min(first + piece_rows, segment.last);
      visit(first, last);
      record.release(first, last);
    }
  }
}

}  // namespace sepcal::base
