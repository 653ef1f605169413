// SPDX-License-Identifier: BSD-3-Clause
// A column of a record as a function of time: a spline a segment, so that nothing crosses
// a segment's edge. A row's noise, by which it lies off the spline, stays with the row wherever the
// spline is read: between two rows an interpolated value has less noise than on them, so that the
// least cost with a delay in it would lie midway between rows, wherever the delay is. A column
// without noise is interpolated.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sepcal/detail/natural_spline.hpp"
#include "sepcal/record.hpp"

namespace sepcal::numerics {

/// Takes out jumps of a whole turn [rad].
void unwrap(std::span<double> angles);

class InterpolatedColumn {
 public:
  /// `angle`: jumps of a whole turn are taken out first. Rows outside the segments of `record` have
  /// no value. A segment of a single row is constant.
  InterpolatedColumn(const Record& record, const std::string& name, bool angle = false);

  /// At `shift` seconds after the times of the rows first, first + 1, ... of one segment: the value
  /// with the row's noise, slope and curvature without.
  void fill(std::size_t first, double shift, std::span<NaturalSpline::Value> values) const;

  /// The same with a shift a row, as many as values.
  void fill(std::size_t first, std::span<const double> shifts,
            std::span<NaturalSpline::Value> values) const;

 private:
  struct Piece {
    Segment segment;
    NaturalSpline spline;
  };

  const Piece& piece_of(std::size_t row) const;

  std::vector<double> time_;   // [s] since the record began: a stamp of 1e9 s leaves few digits
  std::vector<double> noise_;  // of a row, 0 outside the segments
  std::vector<Piece> pieces_;
};

}  // namespace sepcal::numerics
