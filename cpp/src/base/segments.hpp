// SPDX-License-Identifier: BSD-3-Clause
// Segments of a record that may be mapped, whose labels are known as stretches of rows.
#pragma once

#include <vector>

#include "sepcal/record.hpp"

namespace sepcal::base {

/// The public find_segments() of a record's column "time" [s], cut where one of `labels` begins:
/// stretches that cover its rows, or none.
std::vector<Segment> find_segments(const Record& record, const std::vector<Segment>& labels);

}  // namespace sepcal::base
