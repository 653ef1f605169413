// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logs/joined_rates.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <span>
#include <utility>

#include "flight/files/headers.hpp"
#include "flight/files/invalid_cells.hpp"
#include "sepcal/detail/flight/read_as.hpp"
#include "sepcal/detail/quantity.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/joined_rates.hpp"

namespace sepcal {
namespace logs {
namespace {

std::string say_rate(double interval) {
  return std::isfinite(interval) ? fmt::format("{:.3g} Hz", 1.0 / interval) : "one sample";
}

/// Headers by how often each was sampled: "vn_mps, ve_mps (5 Hz) and temp_k (1 Hz)".
class ByRate {
 public:
  void add(const std::string& header, double interval) {
    headers_[say_rate(interval)].push_back(header);
  }
  bool empty() const { return headers_.empty(); }
  std::string say() const {
    std::vector<std::string> groups;
    for (const auto& [rate, headers] : headers_) {
      groups.push_back(fmt::format("{} ({})", fmt::join(headers, ", "), rate));
    }
    return fmt::format("{}", fmt::join(groups, " and "));
  }

 private:
  std::map<std::string, std::vector<std::string>> headers_;
};

const char* say_how(Joining joining) {
  switch (joining) {
    case Joining::smooth:
      return "on parabolas through the samples about each row";
    case Joining::linear:
      return "on straight lines between their samples";
    case Joining::held:
      break;
  }
  return "each held from its sample to the next";
}

/// Of a log's rows, in seconds. Throws Error where there is none.
std::vector<double> read_time(const Flight& flight) {
  std::vector<double> time = files::read_quantity(flight, "time", files::UnitKind::time);
  if (time.empty()) {
    throw Error(
        fmt::format("{}: there is no column of time, as time_s, by which rates are joined; {}",
                    flight.name(), flight.list_columns()));
  }
  return time;
}

bool is_time(const Flight& flight, const Flight::Column& column) {
  const auto time = files::find_quantity(flight, "time", files::UnitKind::time);
  return time && time->column->header == column.header;
}

}  // namespace

void join_rates(Flight& flight, const MeasuredRows& measured, Joining joining,
                std::vector<std::string>& notes) {
  if (flight.is_mapped()) {
    throw OptionError({Option{"join"}, " looks at whole columns, which ", Option{"stream"},
                       " never has in memory; leave one of them out"});
  }
  const std::vector<double> time = read_time(flight);
  ByRate brought;
  const Flight logged = flight;
  for (const Flight::Column& column : logged.columns()) {
    if (is_time(logged, column)) continue;
    if (std::ranges::find(measured.headers, column.header) != measured.headers.end()) continue;
    const auto is_empty = [&](std::size_t row) { return !files::is_reading(column.values[row]); };
    if (std::ranges::none_of(measured.rows, is_empty)) continue;
    const SlowColumn slow(time, column.values, joining, turn_of(column.header));
    std::vector<double> values(column.values.begin(), column.values.end());
    std::size_t filled = 0;
    for (const std::size_t row : measured.rows) {
      const bool stays = joining != Joining::smooth && !is_empty(row);
      if (stays || !files::is_reading(time[row])) continue;
      values[row] = slow.at(time[row]);
      filled += std::isnan(values[row]) ? 0 : 1;
    }
    if (filled == 0) continue;
    brought.add(column.header, slow.interval());
    flight.replace(column.header, std::move(values));
  }
  if (brought.empty()) return;
  notes.push_back(fmt::format("{}: {} are brought to the {} rows of {}, {}", flight.name(),
                              brought.say(), measured.rows.size(),
                              fmt::join(measured.headers, ", "), say_how(joining)));
}

}  // namespace logs

namespace {

using namespace logs;  // this room's own

/// Throws Error where time runs back in it, a value a row in the unit that messages show.
void check_clock(const Flight& flight, std::span<const double> time) {
  double before = -infinity;
  for (std::size_t row = 0; row < time.size(); ++row) {
    if (!files::is_reading(time[row])) continue;
    if (time[row] < before) {
      throw Error(fmt::format(
          "{}: time runs back, from {} to {}; logs are joined by one clock each: sort the rows, "
          "or join the parts one by one",
          flight.locate(row), before, time[row]));
    }
    before = time[row];
  }
  if (!std::isfinite(before)) throw Error(flight.name() + ": no row has a time");
}

/// A log as a probe reads it, and its time [s].
struct ClockedLog {
  ReadFlight read;
  std::vector<double> time;
};

/// Throws Error where there is no time, or where it runs back in the log.
ClockedLog read_clocked(const Flight& flight) {
  ClockedLog log{read_as(flight, {}), {}};
  log.time = read_time(log.read.flight);
  const auto time = files::find_quantity(log.read.flight, "time", files::UnitKind::time);
  const Flight::Column* const logged = time ? flight.find(time->column->logged_header()) : nullptr;
  check_clock(flight, logged == nullptr ? std::span<const double>(log.time) : logged->values);
  return log;
}

std::pair<double, double> ends_of(const std::vector<double>& time) {
  double first = infinity;
  double last = -infinity;
  for (const double t : time) {
    if (!files::is_reading(t)) continue;
    first = std::min(first, t);
    last = std::max(last, t);
  }
  return {first, last};
}

/// Throws OptionError where the clocks have nothing in common.
void check_overlap(const Flight& measured, const std::vector<double>& time, const Flight& other,
                   const std::vector<double>& theirs, double offset) {
  const auto [first, last] = ends_of(time);
  const auto [begins, ends] = ends_of(theirs);
  if (begins <= last && ends >= first) return;
  throw OptionError(
      {fmt::format(
           "{} lasts from {:.10g} to {:.10g} s and {} from {:.10g} to {:.10g} s, which have "
           "no time in common; ",
           measured.name(), first, last, other.name(), begins, ends),
       Option{"offset"},
       fmt::format(" S adds S seconds to the second clock: {:.10g} lets both begin at once",
                   offset + first - begins)});
}

/// Labels of the other log, each from its row on.
std::vector<std::string> labels_at(const Flight& other, const std::vector<double>& theirs,
                                   const std::vector<double>& rows) {
  std::vector<std::string> labels;
  std::size_t next = 0;
  for (const double t : rows) {
    while (next < theirs.size() && !(theirs[next] > t)) ++next;
    labels.push_back(other.maneuvers()[next == 0 ? 0 : next - 1]);
  }
  return labels;
}

std::vector<double> chosen(std::span<const double> values, const std::vector<std::size_t>& rows) {
  std::vector<double> taken;
  for (const std::size_t row : rows) taken.push_back(values[row]);
  return taken;
}

/// What the other log brings: a value a row of the measured one.
struct Brought {
  std::string header;
  std::vector<double> values;
};

/// Rows in which one of them has a value.
std::vector<std::size_t> find_met(const std::vector<Brought>& columns, std::size_t count) {
  std::vector<std::size_t> met;
  for (std::size_t row = 0; row < count; ++row) {
    const auto is_there = [row](const Brought& one) { return !std::isnan(one.values[row]); };
    if (std::ranges::any_of(columns, is_there)) met.push_back(row);
  }
  return met;
}

std::string say_offset(double offset) {
  if (offset == 0.0) return "the clocks are taken as they stand";
  return fmt::format("{:.10g} s are added to its clock", offset);
}

/// The second's columns in the rows of the first.
Flight join_clocked(const ClockedLog& rows, const ClockedLog& brings, Joining joining,
                    double offset) {
  const Flight& measured = rows.read.flight;
  const Flight& other = brings.read.flight;
  const std::vector<double>& time = rows.time;
  std::vector<double> theirs = brings.time;
  for (double& t : theirs) t += offset;
  check_overlap(measured, time, other, theirs, offset);
  std::vector<Brought> columns;
  std::vector<std::string> both;
  ByRate rates;
  for (const Flight::Column& column : other.columns()) {
    if (is_time(other, column)) continue;
    if (measured.find(column.header) != nullptr) {
      both.push_back(column.header);
      continue;
    }
    const SlowColumn slow(theirs, column.values, joining, turn_of(column.header));
    Brought brought{column.header, {}};
    for (const double t : time) brought.values.push_back(slow.at(t));
    rates.add(column.header, slow.interval());
    columns.push_back(std::move(brought));
  }
  if (columns.empty()) {
    throw Error(
        fmt::format("{}: there is no column that {} does not have", other.name(), measured.name()));
  }
  const std::vector<std::size_t> met = find_met(columns, measured.rows());
  if (met.empty()) {
    throw Error(
        fmt::format("{}: no row lies between two samples of {}", measured.name(), other.name()));
  }
  Flight joined(fmt::format("{} with {}", measured.name(), other.name()));
  const auto note = [&](const std::string& text) { joined.note(joined.name() + ": " + text); };
  for (const ClockedLog* log : {&rows, &brings}) {
    for (const std::string& said : log->read.notes) joined.note(said);
  }
  for (const Flight::Column& column : measured.columns()) {
    joined.add(column.header, chosen(column.values, met));
  }
  std::vector<std::string> with_gaps;
  for (const Brought& brought : columns) {
    joined.add(brought.header, chosen(brought.values, met));
    const auto values = joined.find(brought.header)->values;
    const auto gaps = std::ranges::count_if(values, [](double v) { return std::isnan(v); });
    if (gaps > 0) with_gaps.push_back(fmt::format("{} ({})", brought.header, gaps));
  }
  if (!measured.maneuvers().empty()) {
    std::vector<std::string> labels;
    for (const std::size_t row : met) labels.push_back(measured.maneuvers()[row]);
    joined.label(std::move(labels));
  } else if (!other.maneuvers().empty()) {
    joined.label(labels_at(other, theirs, chosen(time, met)));
  }
  note(fmt::format("{} of {} are brought to the rows of {}, {}; {}", rates.say(), other.name(),
                   measured.name(), say_how(joining), say_offset(offset)));
  if (met.size() < measured.rows()) {
    note(fmt::format("{} of {} rows of {} are left out: {} has no samples on both sides of them",
                     measured.rows() - met.size(), measured.rows(), measured.name(), other.name()));
  }
  if (!with_gaps.empty()) {
    note(
        fmt::format("rows without a value, in gaps of the column: {}", fmt::join(with_gaps, ", ")));
  }
  if (!both.empty()) {
    note(fmt::format("{} of {} stay: {} has them too", fmt::join(both, ", "), measured.name(),
                     other.name()));
  }
  return joined;
}

}  // namespace

Flight join_rates(const Flight& measured, const Flight& other, const RateJoining& options) {
  const Joining joining = parse_joining(options.how);
  if (!std::isfinite(options.offset)) {
    throw OptionError({Option{"offset"}, " is no finite number of seconds"});
  }
  return join_clocked(read_clocked(measured), read_clocked(other), joining, options.offset);
}

}  // namespace sepcal
