// SPDX-License-Identifier: BSD-3-Clause
// How a column's values follow one another: on steps, held from row to row, or on straight lines
// between rows that were measured.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sepcal/detail/quantity.hpp"
#include "sepcal/record.hpp"

namespace sepcal::probes {

struct Sequence {
  double step = not_a_number;  // that values stand apart by; NaN where they lie on no steps
  double repeated = 0.0;       // share of rows that repeat the one before
  double hold = 1.0;           // rows that a value is held for; 1 where it is not
  double knot_spacing = 1.0;   // rows from one bend to the next of a column of straight lines
  bool coarse = false;         // rows differ by a step or by none: the noise is below the step

  /// Rows to one that was measured.
  double rows_per_sample() const { return hold > knot_spacing ? hold : knot_spacing; }
};

/// Rows in which time goes on by at least one interval and no gap, under one label; two or more.
std::vector<Segment> find_stretches(std::span<const double> time,
                                    std::span<const std::string> labels);

/// `values` may hold NaN; `stretches`: rows one after another in time.
Sequence find_sequence(std::span<const double> values, const std::vector<Segment>& stretches);

/// The rows of a stretch that begin a run of equal values, what is no number left out.
std::vector<std::size_t> find_new_rows(std::span<const double> values, const Segment& stretch);

/// The rows of the stretches in which a slow column was sampled: where straight lines between
/// samples bend, or, of any other column, where another value begins.
std::vector<std::size_t> find_sampled_rows(std::span<const double> values,
                                           const std::vector<Segment>& stretches);

}  // namespace sepcal::probes
