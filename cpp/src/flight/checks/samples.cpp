// SPDX-License-Identifier: BSD-3-Clause
#include "flight/checks/samples.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "flight/checks/suspects.hpp"

namespace sepcal::checks {
namespace {

/// "every 5th row is new (10 Hz of 50 Hz)"
std::string say_rates(double rows_per_sample, double interval) {
  const double whole = std::round(rows_per_sample);
  const bool even = std::abs(rows_per_sample - whole) < 0.1;
  std::string text = even ? fmt::format("one row in {:.0f}", whole)
                          : fmt::format("one row in {:.2g}", rows_per_sample);
  return text + fmt::format(" ({:.3g} Hz in a log of {:.3g} Hz)", 1 / (rows_per_sample * interval),
                            1 / interval);
}

/// Columns that are slow in one way at one rate are one note.
struct SlowColumns {
  bool held = false;
  bool used = false;  // by a fit
  double rows_per_sample = 1.0;
  std::vector<std::string> headers;
};

template <class Counts>
std::vector<SlowColumns> find_slow(const Log& log, Counts counts) {
  std::vector<SlowColumns> groups;
  for (const LoggedColumn& column : log.columns()) {
    const double rate = column.sequence.rows_per_sample();
    if (rate <= 1.0 || !counts(column)) continue;
    const bool held = column.sequence.hold > 1.0;
    const auto alike = std::ranges::find_if(groups, [&](const SlowColumns& group) {
      return group.held == held && group.used == column.used() &&
             std::abs(group.rows_per_sample / rate - 1) < 0.1;
    });
    if (alike == groups.end()) {
      groups.push_back({held, column.used(), rate, {column.header()}});
    } else {
      alike->headers.push_back(column.header());
    }
  }
  return groups;
}

/// Of those that a fit uses; nullptr where there is none.
const SlowColumns* find_slowest_of(const std::vector<SlowColumns>& groups) {
  const SlowColumns* slowest = nullptr;
  for (const SlowColumns& group : groups) {
    if (!group.used) continue;
    if (slowest == nullptr || group.rows_per_sample > slowest->rows_per_sample) slowest = &group;
  }
  return slowest;
}

/// Takes a row to a sample of the slowest columns that a fit uses.
std::string drop_repeats(const std::vector<SlowColumns>& groups) {
  return fmt::format("--drop-repeats {}", fmt::join(find_slowest_of(groups)->headers, ","));
}

void note_slow(const Log& log, const SlowColumns& group, const std::vector<SlowColumns>& groups,
               std::vector<LogNote>& notes) {
  const double interval = log.interval();
  const double rate = group.rows_per_sample;
  const bool one = group.headers.size() == 1;
  LogNote note = note_on(log, group.held ? "held" : "interpolated",
                         group.used ? Concern::matters : Concern::slight, group.headers);
  note.rows = static_cast<std::size_t>(
      std::round((1.0 - 1.0 / rate) * static_cast<double>(log.flight().rows())));
  note.found = fmt::format("{} {} {}: {} {}", list_headers(group.headers), one ? "is" : "are",
                           group.held ? "held" : "interpolated", say_rates(rate, interval),
                           group.held ? "is new" : "was measured");
  if (!group.used) {
    note.effect = fmt::format("a fit does not use {}; as a driver of an effect {} slow",
                              one ? "it" : "them", one ? "it is" : "they are");
    note.advice = "nothing, unless one drives an effect";
  } else if (group.held) {
    note.effect = fmt::format(
        "repeats count as measurements: the white standard errors are up to {:.2g} times too "
        "small, and on average a row is {:.2g} s late",
        std::sqrt(rate), 0.5 * (rate - 1) * interval);
    note.advice = "take the rows in which the slowest is new: " + drop_repeats(groups);
  } else {
    note.effect = fmt::format(
        "rows between count as measurements: the white standard errors are up to {:.2g} times too "
        "small, and turns between them are cut straight, which no standard error tells",
        std::sqrt(rate));
    note.advice =
        "log what was measured, or take the rows in which the slowest was: " + drop_repeats(groups);
  }
  notes.push_back(std::move(note));
}

void note_coarse(const Log& log, const LoggedColumn& column, std::vector<LogNote>& notes) {
  const double step = column.sequence.step;
  LogNote note = note_on(log, "coarse", Concern::slight, {column.header()});
  note.found = fmt::format("{} has steps of {:.3g} {}, and its noise is smaller", column.header(),
                           step, column.logged.unit->suffix);
  note.effect = fmt::format(
      "the reading is a staircase, off by up to {:.2g} {} for as long as it stays on a step: "
      "residuals look like a slow effect",
      0.5 * step, column.logged.unit->suffix);
  note.advice = "log it with more digits where the sensor has them";
  notes.push_back(std::move(note));
}

}  // namespace

void check_samples(const Log& log, std::vector<LogNote>& notes) {
  const std::vector<SlowColumns> groups = find_slow(log, [](const LoggedColumn&) { return true; });
  for (const SlowColumns& group : groups) note_slow(log, group, groups, notes);
  for (const LoggedColumn& column : log.columns()) {
    if (column.used() && column.sequence.coarse) note_coarse(log, column, notes);
  }
}

std::vector<std::string> find_slowest(const Log& log) {
  constexpr double fewest_left = 150.0;  // rows
  const std::vector<SlowColumns> groups = find_slow(log, [&](const LoggedColumn& column) {
    constexpr std::array lively{"vn", "ve", "airspeed", "dp", "pt", "dpa", "dpb", "mx", "my", "mz"};
    return role_of(log, column) == Role::measured &&
           std::ranges::find(lively, column.name()) != lively.end();
  });
  const SlowColumns* slowest = find_slowest_of(groups);
  if (slowest == nullptr) return {};
  const auto rows = static_cast<double>(log.flight().rows());
  return rows < fewest_left * slowest->rows_per_sample ? std::vector<std::string>()
                                                       : slowest->headers;
}

}  // namespace sepcal::checks
