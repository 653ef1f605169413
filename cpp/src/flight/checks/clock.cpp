// SPDX-License-Identifier: BSD-3-Clause
#include "flight/checks/clock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/gaps.hpp"
#include "numerics/order_statistics.hpp"

namespace sepcal::checks {
namespace {

using numerics::quantile;
using RowList = std::vector<std::size_t>;

/// Rows by what time does on the way to them.
struct Clock {
  std::vector<double> intervals;  // that are positive, ascending
  RowList repeats;
  RowList restarts;
};

Clock read_clock(std::span<const double> time) {
  Clock clock;
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double interval = time[i] - time[i - 1];
    if (interval > 0) clock.intervals.push_back(interval);
    if (interval == 0) clock.repeats.push_back(i);
    if (interval < 0) clock.restarts.push_back(i);
  }
  std::ranges::sort(clock.intervals);
  return clock;
}

void note_faults(const Log& log, const Clock& clock, const std::string& header,
                 std::vector<LogNote>& notes) {
  if (!clock.repeats.empty()) {
    LogNote note = note_on(log, "repeated_stamps", Concern::wrong, {header}, clock.repeats);
    note.found = fmt::format("{} repeats in {} rows, first at {}", header, note.rows,
                             name_row(log, clock.repeats.front()));
    note.effect = "a fit refuses the log: it can't tell which of two rows was first";
    note.advice = "delete one of each two rows, or log stamps with more digits";
    notes.push_back(std::move(note));
  }
  if (!clock.restarts.empty()) {
    LogNote note = note_on(log, "restarts", Concern::wrong, {header}, clock.restarts);
    note.found = fmt::format("{} runs back {} time{}, first at {}", header, note.rows,
                             note.rows == 1 ? "" : "s", name_row(log, clock.restarts.front()));
    note.effect = "a fit refuses the log: its rows are out of order";
    note.advice = "sort the rows by time and delete repeated ones";
    notes.push_back(std::move(note));
  }
}

/// What a log of short pieces does, and what to do about it.
void say_torn(LogNote& note) {
  note.concern = Concern::matters;
  note.effect =
      "pieces between gaps are too short to tell the noise by, and standard errors take it for "
      "white";
  note.advice = "stamp rows at the sensor, or put them on an even clock";
}

void note_gaps(const Log& log, const std::string& header, double gap, std::vector<LogNote>& notes) {
  const std::span<const double> time = log.time();
  RowList rows;
  std::vector<double> lengths;
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (!(time[i] - time[i - 1] > gap)) continue;
    rows.push_back(i);
    lengths.push_back(time[i] - time[i - 1]);
  }
  if (rows.empty()) return;
  const std::size_t piece = time.size() / (rows.size() + 1);
  constexpr std::size_t short_piece = 50;  // rows: too few to tell a noise by
  constexpr std::size_t burst = 20;        // rows that were written at once, rather
  const bool torn = piece < short_piece && rows.size() > 2;
  const bool bursts = torn && piece < burst;
  LogNote note = note_on(log, bursts ? "bursts" : "gaps", Concern::slight, {header}, rows);
  if (bursts) {
    note.found = fmt::format("{} comes in bursts of about {} rows, {:.3g} s apart", header, piece,
                             median(lengths));
  } else {
    const auto longest = std::ranges::max_element(lengths);
    note.found =
        fmt::format("{} gap{} in time, the longest {:.4g} s, before {}", rows.size(),
                    rows.size() == 1 ? "" : "s", *longest,
                    name_row(log, rows[static_cast<std::size_t>(longest - lengths.begin())]));
  }
  note.effect = "each starts a new segment: no derivative, delay or noise model crosses it";
  note.advice = "nothing, if they are meant";
  if (torn) say_torn(note);
  notes.push_back(std::move(note));
}

/// Without the gaps: bursts are short intervals and few long ones, jitter is intervals of all
/// sizes.
void note_spacing(const Log& log, const std::string& header, std::vector<double> intervals,
                  std::vector<LogNote>& notes) {
  constexpr std::size_t fewest = 20;
  if (intervals.size() < fewest) return;
  double sum = 0.0;
  for (const double interval : intervals) sum += interval;
  const double mean = sum / static_cast<double>(intervals.size());
  const double usual = quantile(intervals, 0.5);
  const double low = quantile(intervals, 0.1);
  const double high = quantile(intervals, 0.9);
  if (mean > 2 * usual) {
    LogNote note = note_on(log, "bursts", Concern::matters, {header});
    note.found = fmt::format(
        "{} comes in bursts: half of the rows are within {:.3g} s of the one before, the mean is "
        "{:.3g} s",
        header, usual, mean);
    note.effect =
        "stamps say when rows were written, not when they were measured: derivatives, delays and "
        "lags are off by a burst's length";
    note.advice = "stamp rows at the sensor, or put them on an even clock";
    notes.push_back(std::move(note));
  } else if (high - low > 0.25 * usual) {
    LogNote note = note_on(log, "jitter", Concern::slight, {header});
    note.found = fmt::format(
        "{} is uneven: steps of {:.3g} to {:.3g} s (the middle 80 %), median "
        "{:.3g} s",
        header, low, high, usual);
    note.effect =
        "the noise is modelled row by row as if they were even: standard errors are rough";
    note.advice = "log at an even rate where you can";
    notes.push_back(std::move(note));
  }
}

}  // namespace

void check_clock(const Log& log, std::vector<LogNote>& notes) {
  const auto logged = files::find_quantity(log.flight(), "time", files::UnitKind::time);
  if (!logged) return;
  const std::string& header = logged->column->header;
  Clock clock = read_clock(log.time());
  note_faults(log, clock, header, notes);
  const double gap = base::find_gap(clock.intervals);
  note_gaps(log, header, gap, notes);
  std::erase_if(clock.intervals, [gap](double interval) { return interval > gap; });
  note_spacing(log, header, std::move(clock.intervals), notes);
}

}  // namespace sepcal::checks
