// SPDX-License-Identifier: BSD-3-Clause
// The rows of a column that are no readings of what it measures, by what they look like: a code in
// a reading's place, a reading or some in a row that jump away and come back, a value that stands
// still where the column else does not. Whoever believes a column asks here first.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "flight/files/units.hpp"
#include "sepcal/record.hpp"

namespace sepcal::checks {

using RowList = std::vector<std::size_t>;  // ascending

/// What a column can do, so that what it can't do shows.
struct Manner {
  bool flows = false;       // it has inertia, as an altitude has: it can't jump and come back
  bool rests = false;       // zero is where it rests, as an airspeed does on the ground
  bool may_be_set = false;  // as a throttle is: it may jump at any time
  double turn = 0.0;        // of an angle: a whole one, after which it may begin anew
};

/// Of the probe's quantity in that unit.
Manner manner_of(std::string_view quantity, const files::Unit& unit);

/// Of any other column, by the unit that its header ends with: what has none, a throttle say, may
/// be set.
Manner manner_of_channel(std::string_view header);

struct SuspectRows {
  RowList sentinels;            // a code in a reading's place: -9999
  std::vector<double> codes;    // these codes
  RowList spikes;               // single readings that jump away and come back
  RowList bursts;               // two to thirty such readings in a row
  RowList frozen;               // one value for far longer than the column ever keeps one
  double farthest_spike = 0.0;  // how far a spike jumps
  double spike_share = 0.0;     // of the squares of all that readings differ from their neighbours
  double farthest_burst = 0.0;

  bool empty() const {
    return sentinels.empty() && spikes.empty() && bursts.empty() && frozen.empty();
  }

  /// All of them, ascending.
  RowList all() const;

  /// Makes these rows frozen ones, and nothing else.
  void freeze(const RowList& rows);
};

/// `values` as logged, which may hold NaN; `stretches`: rows one after another in time.
SuspectRows find_suspect_rows(std::span<const double> values, const std::vector<Segment>& stretches,
                              const Manner& manner);

/// Whether the spikes are a tenth of what neighbouring readings differ by, in squares.
inline bool is_heavy(const SuspectRows& rows) { return rows.spike_share > 0.1; }

/// The runs that rows one after another make, in order.
std::vector<Segment> find_runs_of(const RowList& rows);

/// The rows that are in one of the two.
RowList join(const RowList& one, const RowList& other);

/// Finite in all rows and one value in all of them, of which there are at least twenty.
bool is_constant(std::span<const double> values);

}  // namespace sepcal::checks
