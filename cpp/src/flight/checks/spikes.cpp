// SPDX-License-Identifier: BSD-3-Clause
#include "flight/checks/spikes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "numerics/order_statistics.hpp"

namespace sepcal::checks {
namespace {

using files::UnitKind;
using RowList = std::vector<std::size_t>;

/// New readings of a stretch, each against its neighbours.
struct Neighbours {
  RowList rows;
  std::vector<double> values;
  std::vector<double> errors;  // from the median of two before and two after; 0 at the ends
};

Neighbours compare_neighbours(const LoggedColumn& column, const Segment& stretch) {
  Neighbours all;
  all.rows = probes::find_new_rows(column.values, stretch);
  for (const std::size_t row : all.rows) all.values.push_back(column.values[row]);
  all.errors.assign(all.rows.size(), 0.0);
  const std::vector<double>& x = all.values;
  for (std::size_t k = 2; k + 2 < x.size(); ++k) {
    std::array around{x[k - 2], x[k - 1], x[k + 1], x[k + 2]};
    std::ranges::sort(around);
    all.errors[k] = x[k] - 0.5 * (around[1] + around[2]);
  }
  return all;
}

/// What is usual near a reading: the 85 % point of the errors within ten readings of it, itself and
/// those that it spoils left out.
double usual_near(const std::vector<double>& errors, std::size_t k) {
  constexpr std::size_t reach = 12;
  constexpr std::size_t spoiled = 2;
  std::vector<double> near;
  for (std::size_t j = k < reach ? 0 : k - reach; j < std::min(k + reach + 1, errors.size()); ++j) {
    if (j + spoiled < k || j > k + spoiled) near.push_back(std::abs(errors[j]));
  }
  if (near.empty()) return infinity;
  return numerics::select_quantile(near, 0.85);
}

/// A spike goes and comes back: it stands on one side of both neighbours, by half of its error.
bool is_spike(const std::vector<double>& x, const std::vector<double>& errors, std::size_t k) {
  const double before = x[k] - x[k - 1];
  const double after = x[k] - x[k + 1];
  return before * after > 0 &&
         std::min(std::abs(before), std::abs(after)) > 0.5 * std::abs(errors[k]);
}

/// Rows that jump, and what they weigh.
struct Outliers {
  RowList rows;
  double worst = 0.0;  // error
  double share = 0.0;  // of the sum of all squared errors
};

/// Readings beyond eight robust standard deviations of all, and six times what is usual near them.
Outliers find_outliers(const std::vector<Neighbours>& stretches, double scale) {
  Outliers outliers;
  double square = 0.0;
  double all = 0.0;
  for (const Neighbours& part : stretches) {
    for (std::size_t k = 2; k + 2 < part.rows.size(); ++k) {
      const double error = std::abs(part.errors[k]);
      all += error * error;
      if (!(error > 8 * scale) || !is_spike(part.values, part.errors, k)) continue;
      if (!(error > 6 * usual_near(part.errors, k))) continue;
      outliers.rows.push_back(part.rows[k]);
      outliers.worst = std::max(outliers.worst, error);
      square += error * error;
    }
  }
  if (all > 0) outliers.share = square / all;
  return outliers;
}

/// Whether all of them stand within three rows of a jump of the attitude or of the body rates: the
/// vehicle moved, faster than it was logged.
bool is_motion(const RowList& rows, const RowList& moved) {
  constexpr std::size_t near = 3;
  return std::ranges::all_of(rows, [&](std::size_t row) {
    return std::ranges::any_of(
        moved, [row](std::size_t at) { return at <= row + near && row <= at + near; });
  });
}

void note_outliers(const Log& log, const LoggedColumn& column, const Outliers& outliers,
                   std::vector<LogNote>& notes) {
  const bool heavy = outliers.share > 0.1;
  const RowList& rows = outliers.rows;
  LogNote note =
      note_on(log, "outliers", heavy ? Concern::matters : Concern::slight, {column.header()}, rows);
  const double unit = column.logged.unit->convert(1.0) - column.logged.unit->convert(0.0);
  note.found =
      fmt::format("{} jumps for {} single reading{}, by up to {:.3g} {}, first at {}",
                  column.header(), rows.size(), rows.size() == 1 ? "" : "s", outliers.worst / unit,
                  column.logged.unit->suffix, name_row(log, rows.front()));
  note.effect = heavy ? fmt::format(
                            "they are {:.0f} % of all that neighbouring readings differ by, "
                            "in squares: estimates move and standard errors grow",
                            100 * outliers.share)
                      : "each pulls the estimates a little";
  note.advice = "take them out, or fit with --loss huber";
  notes.push_back(std::move(note));
}

/// How far the peak of a parabola stands above a limit that cuts it off for `length` rows, after
/// which it falls by `drop` within `reach` rows: drop = 4 h q (1 + q), q = reach / length.
double height_above(double drop, std::size_t reach, std::size_t length) {
  const double q = static_cast<double>(reach) / static_cast<double>(length);
  return drop / (4 * q * (1 + q));
}

/// Rows at one extreme in runs from which both sides fall away as from a peak that was cut off.
/// Peaks on steps are cut off by less than a step.
RowList find_clipped(const LoggedColumn& column, const Segment& stretch, double extreme,
                     double noise) {
  const auto hold = static_cast<std::size_t>(std::lround(column.sequence.rows_per_sample()));
  const std::size_t fewest = 3 * hold;
  const auto& x = column.values;
  RowList rows;
  for (std::size_t i = stretch.first; i < stretch.last; ++i) {
    if (x[i] != extreme) continue;
    std::size_t end = i;
    while (end < stretch.last && x[end] == extreme) ++end;
    const std::size_t length = end - i;
    const std::size_t before = std::min(length, i - stretch.first);
    const std::size_t after = std::min(length, stretch.last - end);
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

void check_spikes(const Log& log, std::vector<LogNote>& notes) {
  struct Found {
    const LoggedColumn* column;
    Outliers outliers;
  };
  std::vector<Found> found;
  RowList moved;
  for (const LoggedColumn& column : log.columns()) {
    if (column.sequence.knot_spacing > 1.0) continue;  // a spike is a triangle there
    std::vector<Neighbours> stretches;
    std::vector<double> errors;
    for (const Segment& stretch : log.stretches()) {
      stretches.push_back(compare_neighbours(column, stretch));
      for (const double error : stretches.back().errors) errors.push_back(std::abs(error));
    }
    constexpr std::size_t fewest = 200;  // readings, of which what is usual can be told
    if (errors.size() < fewest) continue;
    const double step =
        column.logged.unit->convert(column.sequence.step) - column.logged.unit->convert(0.0);
    const double noise = 1.4826 * median(errors);
    const double scale = std::isfinite(step) ? std::max(noise, step) : noise;
    Outliers outliers = find_outliers(stretches, scale);
    if (column.kind() == UnitKind::angle || column.kind() == UnitKind::rate) {
      moved.insert(moved.end(), outliers.rows.begin(), outliers.rows.end());
    } else if (column.used) {
      note_clipping(log, column, scale, notes);
      found.push_back({&column, std::move(outliers)});
    }
  }
  for (const auto& [column, outliers] : found) {
    if (!outliers.rows.empty() && !is_motion(outliers.rows, moved)) {
      note_outliers(log, *column, outliers, notes);
    }
  }
}

}  // namespace sepcal::checks
