// SPDX-License-Identifier: BSD-3-Clause
#include "base/parts_of_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace sepcal::base {

std::vector<Segment> join_segments(const std::vector<Segment>& segments) {
  std::vector<Segment> joined;
  std::size_t row = 0;
  for (const Segment& segment : segments) {
    joined.push_back({segment.label, row, row + segment.rows()});
    row += segment.rows();
  }
  return joined;
}

std::vector<double> gather_time(const Record& record) {
  std::vector<double> time(record.rows());
  if (!record.has("time")) {
    std::iota(time.begin(), time.end(), 0.0);
    return time;
  }
  const auto column = record.column("time");
  auto to = time.begin();
  for (const Segment& segment : record.segments()) {
    to = std::ranges::copy(column.subspan(segment.first, segment.rows()), to).out;
  }
  return time;
}

std::vector<Part> parts_by_label(const std::vector<Segment>& joined) {
  std::vector<Part> parts;
  for (const Segment& stretch : joined) {
    const auto same = std::ranges::find(parts, stretch.label, &Part::name);
    if (same == parts.end()) {
      parts.push_back({stretch.label, {stretch}});
    } else {
      same->stretches.push_back(stretch);
    }
  }
  return parts;
}

std::vector<Part> parts_by_time(const std::vector<Segment>& joined, const std::vector<double>& time,
                                std::size_t count) {
  std::vector<Part> parts;
  const std::size_t rows = time.size();
  count = std::min(count, rows);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t first = rows * i / count;
    const std::size_t last = rows * (i + 1) / count;
    Part part{fmt::format("{:.6g}:{:.6g}", time[first], time[last - 1]), {}};
    for (const Segment& stretch : joined) {
      const Segment shared{"", std::max(first, stretch.first), std::min(last, stretch.last)};
      if (shared.first < shared.last) part.stretches.push_back(shared);
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace sepcal::base
