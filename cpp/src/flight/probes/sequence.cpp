// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/sequence.hpp"

#include <algorithm>
#include <cmath>

#include "base/gaps.hpp"
#include "numerics/order_statistics.hpp"

namespace sepcal::probes {
namespace {

using numerics::select_quantile;

constexpr std::size_t fewest_to_tell = 20;  // changes, bends or levels, of which a rule can be told

/// Distances between the levels that the column takes.
std::vector<double> find_spacings(std::span<const double> values) {
  std::vector<double> levels;
  std::ranges::copy_if(values, std::back_inserter(levels),
                       [](double value) { return std::isfinite(value); });
  std::ranges::sort(levels);
  std::vector<double> spacings;
  for (std::size_t i = 1; i < levels.size(); ++i) {
    if (levels[i] > levels[i - 1]) spacings.push_back(levels[i] - levels[i - 1]);
  }
  return spacings;
}

/// Steps show in levels that mostly lie one to three of them apart; what is continuous leaves
/// spacings of all sizes. A sixth of a step is left to rounding: 0.1743 and 0.1747 degrees.
double find_step(std::vector<double>& spacings) {
  if (spacings.size() < 2) return not_a_number;
  const double step = select_quantile(spacings, 0.1);
  if (select_quantile(spacings, 0.5) > 3.5 * step) return not_a_number;
  const auto on_steps = std::ranges::count_if(spacings, [step](double spacing) {
    const double steps = spacing / step;
    return std::abs(steps - std::round(steps)) < 1.0 / 6 && steps > 0.5;
  });
  const bool most = 10 * static_cast<std::size_t>(on_steps) >= 8 * spacings.size();
  return most ? step : not_a_number;
}

/// Runs of equal values and the jumps from one to the next.
struct Runs {
  std::vector<double> lengths;  // of those that no end of a stretch cuts off, ascending
  std::vector<double> jumps;
  std::size_t rows = 0;   // that have a row before them
  std::size_t equal = 0;  // and repeat it
};

Runs find_equal_runs(std::span<const double> values, const std::vector<Segment>& stretches) {
  Runs runs;
  for (const Segment& stretch : stretches) {
    double length = 1;
    bool whole = false;
    for (std::size_t i = stretch.first + 1; i < stretch.last; ++i) {
      const double jump = std::abs(values[i] - values[i - 1]);
      ++runs.rows;
      if (jump == 0) {
        ++runs.equal;
        ++length;
        continue;
      }
      if (whole) runs.lengths.push_back(length);
      if (std::isfinite(jump)) runs.jumps.push_back(jump);
      whole = true;
      length = 1;
    }
  }
  std::ranges::sort(runs.lengths);
  return runs;
}

/// Held where two rows in five repeat the one before and a new value is another by far more than
/// what values stand apart by: a slow quantity on steps repeats too. A run of twenty usual ones is
/// a quantity at rest, and repeats that are few on the whole and uneven are one that now and then
/// rests.
double find_hold(Runs& runs, std::vector<double>& spacings, double step) {
  if (runs.lengths.size() < fewest_to_tell || runs.jumps.empty()) return 1.0;
  if (!std::isfinite(step) && spacings.empty()) return 1.0;
  const double least = std::isfinite(step) ? 2.5 * step : 15 * select_quantile(spacings, 0.1);
  if (select_quantile(runs.jumps, 0.5) < least) return 1.0;
  const auto mean_of = [&](double longest) {
    double rows = 0;
    double count = 0;
    for (const double length : runs.lengths) {
      if (length > longest) break;
      rows += length;
      ++count;
    }
    return rows / count;
  };
  const double hold = mean_of(20 * mean_of(infinity));
  const bool even = numerics::quantile(runs.lengths, 0.2) > 0.7 * hold;
  return hold < 5.0 / 3.0 || (hold < 2.5 && !even) ? 1.0 : hold;
}

/// How far rows are from the line through their neighbours, where these differ.
struct Bends {
  std::vector<std::size_t> knots;  // bent rows, of some in a row the first
  std::vector<double> bent;        // farther than a digit
  std::vector<double> between;     // rows from one to the next, of some in a row the first
  double rows = 0.0;               // that neither stand still nor at an end
};

Bends find_bends(std::span<const double> values, const std::vector<Segment>& stretches,
                 double digit) {
  Bends bends;
  for (const Segment& stretch : stretches) {
    std::size_t knot = 0;  // the last bent row that follows none; 0: there was none yet
    bool bent_before = false;
    for (std::size_t i = stretch.first + 1; i + 1 < stretch.last; ++i) {
      const double bend = std::abs(values[i] - 0.5 * (values[i - 1] + values[i + 1]));
      const bool moves = std::isfinite(bend) && values[i - 1] != values[i + 1];
      const bool bent = moves && bend > digit;
      if (moves) ++bends.rows;
      if (bent) bends.bent.push_back(bend);
      if (bent && !bent_before) {  // a bend between two rows shows in both of them
        bends.knots.push_back(i);
        if (knot > 0) bends.between.push_back(static_cast<double>(i - knot));
        knot = i;
      }
      bent_before = bent;
    }
  }
  return bends;
}

/// The mean of those that are half to one and a half times the usual one.
double mean_of_usual(const std::vector<double>& values, double usual) {
  double sum = 0.0;
  double count = 0.0;
  for (const double value : values) {
    if (value < 0.5 * usual || value > 1.5 * usual) continue;
    sum += value;
    ++count;
  }
  return sum / count;
}

/// How far off a line rounding puts a row.
double find_digit(std::span<const double> values, const std::vector<double>& spacings) {
  double widest = 0.0;
  for (const double value : values) {
    if (std::isfinite(value)) widest = std::max(widest, std::abs(value));
  }
  return std::max(1.05 * std::ranges::min(spacings), 1e-12 * widest);
}

/// Interpolated where most rows stand on the line of their neighbours to the last digit, the others
/// far off it, and these come at even distances throughout.
double find_knot_spacing(std::span<const double> values, const std::vector<Segment>& stretches,
                         const std::vector<double>& spacings) {
  if (spacings.size() < fewest_to_tell) return 1.0;
  const double digit = find_digit(values, spacings);
  Bends bends = find_bends(values, stretches, digit);
  if (bends.between.size() < fewest_to_tell) return 1.0;
  const double usual = select_quantile(bends.between, 0.5);
  const double middle = select_quantile(bends.between, 0.8) - select_quantile(bends.between, 0.2);
  const bool even = middle <= std::max(1.0, 0.2 * usual);
  const bool throughout = static_cast<double>(bends.between.size()) * usual > 0.7 * bends.rows;
  const bool mostly_straight = static_cast<double>(bends.bent.size()) < 0.6 * bends.rows;
  const bool far_off = select_quantile(bends.bent, 0.5) > 10 * digit;
  if (!even || !throughout || !mostly_straight || !far_off) return 1.0;
  return mean_of_usual(bends.between, usual);
}

/// Rows mostly differ by a step or by none, though the quantity moves over steps enough to matter:
/// a step is more than a 250th of what nine tenths of the values span.
bool is_coarse(const Runs& runs, std::span<const double> values, double step) {
  if (!std::isfinite(step) || runs.jumps.size() < fewest_to_tell) return false;
  const auto small =
      std::ranges::count_if(runs.jumps, [step](double jump) { return jump < 1.5 * step; });
  if (runs.equal + static_cast<std::size_t>(small) < runs.rows * 8 / 10) return false;
  std::vector<double> finite;
  std::ranges::copy_if(values, std::back_inserter(finite),
                       [](double value) { return std::isfinite(value); });
  return 250 * step > select_quantile(finite, 0.95) - select_quantile(finite, 0.05);
}

}  // namespace

Sequence find_sequence(std::span<const double> values, const std::vector<Segment>& stretches) {
  std::vector<double> spacings = find_spacings(values);
  Runs runs = find_equal_runs(values, stretches);
  Sequence sequence;
  sequence.step = find_step(spacings);
  if (runs.rows == 0) return sequence;
  sequence.repeated = static_cast<double>(runs.equal) / static_cast<double>(runs.rows);
  sequence.hold = find_hold(runs, spacings, sequence.step);
  if (sequence.hold > 1.0) return sequence;
  sequence.knot_spacing = find_knot_spacing(values, stretches, spacings);
  sequence.coarse = sequence.knot_spacing == 1.0 && is_coarse(runs, values, sequence.step);
  return sequence;
}

std::vector<std::size_t> find_new_rows(std::span<const double> values, const Segment& stretch) {
  std::vector<std::size_t> rows;
  for (std::size_t i = stretch.first; i < stretch.last; ++i) {
    if (std::isfinite(values[i]) && (rows.empty() || values[i] != values[rows.back()])) {
      rows.push_back(i);
    }
  }
  return rows;
}

std::vector<std::size_t> find_sampled_rows(std::span<const double> values,
                                           const std::vector<Segment>& stretches) {
  if (find_sequence(values, stretches).knot_spacing > 1.0) {
    return find_bends(values, stretches, find_digit(values, find_spacings(values))).knots;
  }
  std::vector<std::size_t> rows;
  for (const Segment& stretch : stretches) {
    const std::vector<std::size_t> own = find_new_rows(values, stretch);
    rows.insert(rows.end(), own.begin(), own.end());
  }
  return rows;
}

std::vector<Segment> find_stretches(std::span<const double> time,
                                    std::span<const std::string> labels) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (time[i] > time[i - 1]) intervals.push_back(time[i] - time[i - 1]);
  }
  const double gap = base::find_gap(std::move(intervals));
  std::vector<Segment> stretches;
  for (std::size_t i = 0; i < time.size(); ++i) {
    const bool goes_on = i > 0 && time[i] > time[i - 1] && time[i] - time[i - 1] <= gap &&
                         (labels.empty() || labels[i] == labels[i - 1]);
    if (!goes_on) stretches.push_back({"", i, i});
    stretches.back().last = i + 1;
  }
  std::erase_if(stretches, [](const Segment& stretch) { return stretch.rows() < 2; });
  return stretches;
}

}  // namespace sepcal::probes
