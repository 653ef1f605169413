// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/interpolated_column.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "sepcal/error.hpp"

namespace sepcal::numerics {

void unwrap(std::span<double> angles) {
  for (std::size_t i = 1; i < angles.size(); ++i) {
    angles[i] = angles[i - 1] + std::remainder(angles[i] - angles[i - 1], 2.0 * std::numbers::pi);
  }
}

InterpolatedColumn::InterpolatedColumn(const Record& record, const std::string& name, bool angle) {
  const std::span<const double> time = record.column("time");
  const std::span<const double> column = record.column(name);
  const double origin = time.empty() ? 0.0 : time.front();
  std::ranges::transform(time, std::back_inserter(time_), [&](double at) { return at - origin; });
  for (const Segment& segment : record.segments()) {
    const auto part = [&](std::span<const double> values) {
      const auto rows = values.subspan(segment.first, segment.rows());
      return std::vector<double>(rows.begin(), rows.end());
    };
    std::vector<double> times = part(time_);
    std::vector<double> values = part(column);
    if (angle) unwrap(values);
    if (segment.rows() == 1) {  // a line of no slope through the lone row
      times.push_back(times.front() + 1.0);
      values.push_back(values.front());
    }
    pieces_.push_back({segment, NaturalSpline(std::move(times), std::move(values))});
  }
}

const InterpolatedColumn::Piece& InterpolatedColumn::piece_of(std::size_t row) const {
  const auto after = std::ranges::upper_bound(
      pieces_, row, {}, [](const Piece& piece) { return piece.segment.last; });
  if (after == pieces_.end() || row < after->segment.first) {
    throw Error("row " + std::to_string(row) + " is in no segment of the record");
  }
  return *after;
}

void InterpolatedColumn::fill(std::size_t first, double shift,
                              std::span<NaturalSpline::Value> values) const {
  const Piece& piece = piece_of(first);
  std::size_t hint = first - piece.segment.first;
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = piece.spline.at(time_[first + i] + shift, hint);
  }
}

void InterpolatedColumn::fill(std::size_t first, std::span<const double> shifts,
                              std::span<NaturalSpline::Value> values) const {
  const Piece& piece = piece_of(first);
  std::size_t hint = first - piece.segment.first;
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = piece.spline.at(time_[first + i] + shifts[i], hint);
  }
}

}  // namespace sepcal::numerics
