// SPDX-License-Identifier: BSD-3-Clause
#include "flight/checks/clipping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "flight/checks/excursions.hpp"
#include "numerics/order_statistics.hpp"

namespace sepcal::checks {
namespace {

using files::UnitKind;

/// How far the peak of a parabola stands above a limit that cuts it off for `length` rows, after
/// which it falls by `drop` within `reach` rows: drop = 4 h q (1 + q), q = reach / length.
double height_above(double drop, std::size_t reach, std::size_t length) {
  const double q = static_cast<double>(reach) / static_cast<double>(length);
  return drop / (4 * q * (1 + q));
}

/// The longest run of equal values, but for the extreme, among some on either side of rows [first,
/// last): what is held there.
std::size_t held_beside(const std::vector<double>& x, const Segment& stretch, double extreme,
                        std::size_t first, std::size_t last) {
  constexpr std::size_t runs = 12;
  std::size_t longest = 1;
  const auto count = [&](double value, std::size_t length) {
    if (value != extreme) longest = std::max(longest, length);
  };
  std::size_t i = last;
  for (std::size_t k = 0; k < runs && i < stretch.last; ++k) {
    const std::size_t begin = i;
    while (i < stretch.last && x[i] == x[begin]) ++i;
    count(x[begin], i - begin);
  }
  i = first;
  for (std::size_t k = 0; k < runs && i > stretch.first; ++k) {
    const std::size_t end = i;
    while (i > stretch.first && x[i - 1] == x[end - 1]) --i;
    count(x[end - 1], end - i);
  }
  return longest;
}

/// Rows at one extreme in runs from which both sides fall away as from a peak that was cut off.
/// Peaks on steps are cut off by less than a step, and a held reading stands no longer than those
/// beside it.
RowList find_clipped(const LoggedColumn& column, const Segment& stretch, double extreme,
                     double noise) {
  const auto& x = column.values;
  RowList rows;
  for (std::size_t i = stretch.first; i < stretch.last; ++i) {
    if (x[i] != extreme) continue;
    std::size_t end = i;
    while (end < stretch.last && x[end] == extreme) ++end;
    const std::size_t length = end - i;
    const std::size_t before = std::min(length, i - stretch.first);
    const std::size_t after = std::min(length, stretch.last - end);
    const std::size_t fewest = 3 * held_beside(x, stretch, extreme, i, end);
    if (std::min({length, before, after}) >= fewest) {
      const double height =
          std::min(height_above(std::abs(extreme - x[i - before]), before, length),
                   height_above(std::abs(extreme - x[end + after - 1]), after, length));
      for (std::size_t row = i; height > 3 * noise && row < end; ++row) rows.push_back(row);
    }
    i = end;
  }
  return rows;
}

void note_clipping(const Log& log, const LoggedColumn& column, double noise,
                   std::vector<LogNote>& notes) {
  double least = infinity;
  double largest = -infinity;
  for (const double value : column.values) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    largest = std::max(largest, value);
  }
  for (const double extreme : {least, largest}) {
    if (extreme == 0 && manner_of(column.name(), *column.logged.unit).rests) continue;
    RowList rows;
    for (const Segment& stretch : log.stretches()) {
      const RowList found = find_clipped(column, stretch, extreme, noise);
      rows.insert(rows.end(), found.begin(), found.end());
    }
    if (rows.empty()) continue;
    LogNote note = note_on(log, "clipped", Concern::matters, {column.header()}, rows);
    note.found = fmt::format(
        "{} stands at its {} of {:.6g} {} in {} rows and cuts off its peaks, "
        "first at {}",
        column.header(), extreme == least ? "least" : "largest",
        column.logged.column->values[rows.front()], column.logged.unit->suffix, rows.size(),
        name_row(log, rows.front()));
    note.effect = "the sensor was at its limit there: scale errors come out too small";
    note.advice = "set a wider range of the sensor, or take these rows out";
    notes.push_back(std::move(note));
  }
}

}  // namespace

void check_clipping(const Log& log, std::vector<LogNote>& notes) {
  for (const LoggedColumn& column : log.columns()) {
    const bool turns = column.kind() == UnitKind::angle || column.kind() == UnitKind::rate;
    if (!column.used() || turns || column.sequence.knot_spacing > 1.0) continue;
    const double noise = reading_noise(column.values, log.stretches());
    if (std::isnan(noise)) continue;
    const double step =
        column.logged.unit->convert(column.sequence.step) - column.logged.unit->convert(0.0);
    note_clipping(log, column, std::isfinite(step) ? std::max(noise, step) : noise, notes);
  }
}

}  // namespace sepcal::checks
