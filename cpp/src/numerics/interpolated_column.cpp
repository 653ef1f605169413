// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/interpolated_column.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>
#include <utility>

#include "base/gaps.hpp"
#include "numerics/regression_spline.hpp"
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
  noise_.assign(time_.size(), 0.0);
  std::vector<double> values(column.begin(), column.end());
  std::vector<Stretch> stretches;
  std::vector<double> intervals;
  for (const Segment& segment : record.segments()) {
    const auto times = std::span(time_).subspan(segment.first, segment.rows());
    const auto heights = std::span(values).subspan(segment.first, segment.rows());
    if (angle) unwrap(heights);
    stretches.push_back({times, heights});
    for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(times[i] - times[i - 1]);
  }
  const double spacing =
      intervals.empty() ? 0.0 : choose_spacing(stretches, base::usual_interval(intervals));
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    const Segment& segment = record.segments()[k];
    std::vector<double> times(stretches[k].times.begin(), stretches[k].times.end());
    std::vector<double> heights(stretches[k].values.begin(), stretches[k].values.end());
    if (spacing > 0.0) {
      const std::vector<double> logged = std::move(heights);
      heights = fit_spline(stretches[k], spacing);
      std::ranges::transform(logged, heights,
                             std::next(noise_.begin(), static_cast<std::ptrdiff_t>(segment.first)),
                             std::minus());
    }
    if (segment.rows() == 1) {  // a line of no slope through the lone row
      times.push_back(times.front() + 1.0);
      heights.push_back(heights.front());
    }
    pieces_.push_back({segment, NaturalSpline(std::move(times), std::move(heights))});
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
  fill(first, std::vector<double>(values.size(), shift), values);
}

void InterpolatedColumn::fill(std::size_t first, std::span<const double> shifts,
                              std::span<NaturalSpline::Value> values) const {
  const Piece& piece = piece_of(first);
  std::size_t hint = first - piece.segment.first;
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = piece.spline.at(time_[first + i] + shifts[i], hint);
    values[i].value += noise_[first + i];
  }
}

}  // namespace sepcal::numerics
