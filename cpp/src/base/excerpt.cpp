// SPDX-License-Identifier: BSD-3-Clause
#include "base/excerpt.hpp"

#include <utility>
#include <vector>

namespace sepcal::base {

Record excerpt(const Record& record) {
  const std::size_t rows = record.rows();
  if (!record.is_mapped() || rows <= excerpt_rows) return record;
  constexpr std::size_t length = excerpt_rows / excerpt_stretches;
  std::vector<Segment> cut;
  std::size_t before = 0;  // rows of the segments before
  std::size_t stretch = 0;
  for (const Segment& segment : record.segments()) {
    while (stretch < excerpt_stretches) {
      const std::size_t begin = stretch * (rows - length) / (excerpt_stretches - 1);
      const std::size_t from = std::max(begin, before);
      const std::size_t to = std::min(begin + length, before + segment.rows());
      if (from < to) {
        cut.push_back({segment.label, segment.first + from - before, segment.first + to - before});
      }
      if (begin + length > before + segment.rows()) break;  // it goes on in the next segment
      ++stretch;
    }
    before += segment.rows();
  }
  Record part = record;
  return part.cut(std::move(cut));
}

}  // namespace sepcal::base
