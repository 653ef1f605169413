// SPDX-License-Identifier: BSD-3-Clause
// A record in parts, to see where something differs. Rows are counted as they are gathered: those
// of the segments, one after another.
#pragma once

#include <string>
#include <vector>

#include "sepcal/record.hpp"

namespace sepcal::base {

struct Part {
  std::string name;
  std::vector<Segment> stretches;  // gathered rows, each without a gap
};

/// The segments one after another, as gather_rows() lays their rows out.
std::vector<Segment> join_segments(const std::vector<Segment>& segments);

/// `time` [s] of the gathered rows, their numbers where the record has none.
std::vector<double> gather_time(const Record& record);

/// One part a label, in order of first appearance.
std::vector<Part> parts_by_label(const std::vector<Segment>& joined);

/// At most `count` spans of equal numbers of rows, cut again where a segment ends; named by their
/// first and last `time`.
std::vector<Part> parts_by_time(const std::vector<Segment>& joined, const std::vector<double>& time,
                                std::size_t count);

}  // namespace sepcal::base
