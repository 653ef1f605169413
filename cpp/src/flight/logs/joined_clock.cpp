// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logs/joined_clock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/gaps.hpp"
#include "flight/files/headers.hpp"
#include "flight/files/invalid_cells.hpp"

namespace sepcal::logs {
namespace {

constexpr std::size_t shortest_part = 10;  // rows
constexpr double least_gap = 1.0;          // s

/// What time does in the rows that hold a reading, in the column's own unit.
struct Clock {
  std::vector<std::size_t> restarts;  // rows before which time runs back
  bool to_the_start = true;           // each of them to the first half of the part before it
  double shortest = std::numeric_limits<double>::infinity();  // of these ways back
  std::vector<double> intervals;                              // within parts
};

Clock read_clock(std::span<const double> time) {
  Clock clock;
  double before = std::numeric_limits<double>::quiet_NaN();
  double began = before;
  for (std::size_t row = 0; row < time.size(); ++row) {
    if (!files::is_reading(time[row])) continue;
    if (time[row] < before) {
      clock.restarts.push_back(row);
      clock.shortest = std::min(clock.shortest, before - time[row]);
      clock.to_the_start = clock.to_the_start && time[row] < 0.5 * (began + before);
    }
    if (!(time[row] >= before)) began = time[row];
    if (time[row] > before) clock.intervals.push_back(time[row] - before);
    before = time[row];
  }
  return clock;
}

/// Parts of some rows each, and every way back as long as such a part and to where the part before
/// it began rather than where it ended: neither rows out of order nor a stamp that is off.
bool starts_anew(const Clock& clock, std::size_t rows) {
  if (clock.restarts.empty() || clock.intervals.empty() || !clock.to_the_start) return false;
  const double usual = base::usual_interval(clock.intervals);
  if (clock.shortest < static_cast<double>(shortest_part) * usual) return false;
  std::size_t first = 0;
  for (const std::size_t restart : clock.restarts) {
    if (restart - first < shortest_part) return false;
    first = restart;
  }
  return rows - first >= shortest_part;
}

}  // namespace

void join_clock(Flight& flight, std::vector<std::string>& notes) {
  if (flight.is_mapped()) return;
  const auto logged = files::find_quantity(flight, "time", files::UnitKind::time);
  if (!logged) return;
  const std::span<const double> time = logged->column->values;
  const Clock clock = read_clock(time);
  if (!starts_anew(clock, time.size())) return;
  const double second = 1.0 / logged->unit->convert(1.0);
  const double gap = std::max(least_gap * second, 2.0 * base::find_gap(clock.intervals));
  std::vector<double> joined(time.begin(), time.end());
  double offset = 0.0;
  double last = 0.0;
  auto restart = clock.restarts.begin();
  for (std::size_t row = 0; row < joined.size(); ++row) {
    if (restart != clock.restarts.end() && row == *restart) {
      offset = last + gap - time[row];
      ++restart;
    }
    joined[row] += offset;
    if (files::is_reading(joined[row])) last = joined[row];
  }
  const std::string header = logged->column->header;
  notes.push_back(fmt::format(
      "{}: {} runs back {}, first at {}: taken for {} that were joined, each with a clock of its "
      "own; each follows the one before after {:.3g} s",
      flight.name(), header,
      clock.restarts.size() == 1 ? "once" : fmt::format("{} times", clock.restarts.size()),
      flight.locate(clock.restarts.front()),
      clock.restarts.size() == 1 ? "two logs" : fmt::format("{} logs", clock.restarts.size() + 1),
      gap / second));
  flight.replace(header, std::move(joined));
}

}  // namespace sepcal::logs
