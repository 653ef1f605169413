// SPDX-License-Identifier: BSD-3-Clause
// A column of a record as a function of time: a natural spline a segment, so that nothing crosses a
// segment's edge.
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

  /// At `shift` seconds after the times of the rows first, first + 1, ... of one segment.
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

  std::vector<double> time_;  // [s] since the record began: a stamp of 1e9 s leaves few digits
  std::vector<Piece> pieces_;
};

}  // namespace sepcal::numerics
