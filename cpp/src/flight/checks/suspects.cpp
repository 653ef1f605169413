// SPDX-License-Identifier: BSD-3-Clause
#include "flight/checks/suspects.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>

#include "flight/checks/column_name.hpp"

namespace sepcal::checks {
namespace {

using files::UnitKind;

constexpr std::size_t near = 3;  // rows, within which two columns tell of one motion

bool is_near(std::size_t row, const RowList& rows) {
  const auto after = std::ranges::lower_bound(rows, row < near ? 0 : row - near);
  return after != rows.end() && *after <= row + near;
}

/// Whether all of them stand by jumps of the other columns.
bool is_motion(const RowList& rows, const RowList& moved) {
  return std::ranges::all_of(rows, [&](std::size_t row) { return is_near(row, moved); });
}

/// What jumps where other sensors do is the vehicle, which turns faster than it was logged.
void forget_motion(SuspectColumn& column, const RowList& moved) {
  if (is_motion(column.rows.spikes, moved)) column.rows.spikes.clear();
  if (is_motion(column.rows.bursts, moved)) column.rows.bursts.clear();
}

bool is_axis(std::string_view quantity) {
  return quantity == "mx" || quantity == "my" || quantity == "mz";
}

bool is_of_aircraft(const Log& log) { return log.looks_at() != probes::LooksAt::readings; }

bool is_velocity(std::string_view quantity) {
  return quantity == "vn" || quantity == "ve" || quantity == "vd";
}

/// What reads the quantity, and at a fault all that it reads: of a probe the attitude and the rest,
/// of an aircraft, whose motion all of them show, each unit.
std::string_view sensor_of(const Log& log, const LoggedColumn& column) {
  if (!is_of_aircraft(log)) {
    const bool turns = column.kind() == UnitKind::angle || column.kind() == UnitKind::rate;
    return turns ? "attitude" : "others";
  }
  const std::string_view name = column.name();
  if (name == "roll" || name == "pitch" || name == "yaw") return "attitude";
  if (is_velocity(name)) return "receiver";
  const UnitKind kind = column.kind();
  if (kind == UnitKind::acceleration) return "accelerometers";
  return kind == UnitKind::rate || kind == UnitKind::angular_acceleration ? "gyros" : "air data";
}

/// Of an aircraft's rates too: they are logged fast, and others tell whether it turned.
Manner manner_in(const Log& log, const LoggedColumn& column) {
  Manner manner = manner_of(column.name(), *column.logged.unit);
  if (is_of_aircraft(log)) manner.flows = true;
  return manner;
}

/// Where a column goes on: of an aircraft also from one maneuver to the next, as these are short
/// and what is usual would not be seen in one of them.
std::vector<Segment> find_stretches_of(const Log& log) {
  return is_of_aircraft(log) ? probes::find_stretches(log.time(), {}) : log.stretches();
}

/// Whether the air tells that the vehicle stands in these rows.
bool stands_in_air(const Log& log, std::size_t first, std::size_t last) {
  struct Least {
    const char* quantity;
    double flow;
  };
  for (const auto& [quantity, flow] : {Least{"airspeed", 5.0}, Least{"dp", 15.0}}) {  // m/s, Pa
    const LoggedColumn* const column = log.find(quantity);
    if (column == nullptr) continue;
    double largest = 0.0;
    for (std::size_t row = first; row < last; ++row) {
      if (std::isfinite(column->values[row])) largest = std::max(largest, column->values[row]);
    }
    return largest < flow;
  }
  return false;
}

/// Rows in which a receiver has no fix: all that it logs of the velocity is 0 there, and at once
/// the vehicle moves, before or after.
RowList find_without_fix(const Log& log, const std::vector<Segment>& stretches) {
  constexpr std::size_t fewest = 4;  // in a row; fewer are single readings that jump
  constexpr double moves = 5.0;      // m/s
  std::vector<const LoggedColumn*> velocity;
  for (const LoggedColumn& column : log.columns()) {
    if (is_velocity(column.name())) velocity.push_back(&column);
  }
  RowList rows;
  if (velocity.size() < 2) return rows;
  const auto speed = [&](std::size_t row) {
    double sum = 0.0;
    for (const LoggedColumn* column : velocity) sum += column->values[row] * column->values[row];
    return std::sqrt(sum);
  };
  for (const Segment& stretch : stretches) {
    for (std::size_t first = stretch.first; first < stretch.last; ++first) {
      if (speed(first) != 0.0) continue;
      std::size_t last = first;
      while (last < stretch.last && speed(last) == 0.0) ++last;
      const bool moved = first > stretch.first && speed(first - 1) > moves;
      const bool goes_on = last < stretch.last && speed(last) > moves;
      if (last - first >= fewest && (moved || goes_on) && !stands_in_air(log, first, last)) {
        for (std::size_t row = first; row < last; ++row) rows.push_back(row);
      }
      first = last;
    }
  }
  return rows;
}

/// The columns of the probe's quantities, in the log's order of quantities.
std::vector<SuspectColumn> find_in_quantities(const Log& log,
                                              const std::vector<Segment>& stretches) {
  std::vector<SuspectColumn> columns;
  const RowList without_fix = find_without_fix(log, stretches);
  std::map<std::string_view, RowList> jumps;  // of each sensor
  std::array<RowList, 3> axes;
  for (const LoggedColumn& column : log.columns()) {
    const Manner manner = manner_in(log, column);
    SuspectColumn suspect{column.header(), std::string(column.logged.unit->suffix),
                          role_of(log, column), manner,
                          find_suspect_rows(column.logged.column->values, stretches, manner)};
    if (is_velocity(column.name()) && !without_fix.empty()) suspect.rows.freeze(without_fix);
    const RowList own = join(suspect.rows.spikes, suspect.rows.bursts);
    RowList& all = jumps[sensor_of(log, column)];
    all = join(all, own);
    if (is_axis(column.name())) axes[static_cast<std::size_t>(column.name()[1] - 'x')] = own;
    columns.push_back(std::move(suspect));
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const LoggedColumn& column = log.columns()[i];
    const std::string_view sensor = sensor_of(log, column);
    RowList elsewhere;
    for (const auto& [other, rows] : jumps) {
      if (other != sensor) elsewhere = join(elsewhere, rows);
    }
    forget_motion(columns[i], elsewhere);
    const bool may_turn = sensor == "attitude" && !is_of_aircraft(log);
    if (may_turn) columns[i].rows.spikes.clear();  // it may turn as fast
    if (!is_axis(column.name())) continue;
    const auto own = static_cast<std::size_t>(column.name()[1] - 'x');
    forget_motion(columns[i], join(axes[(own + 1) % 3], axes[(own + 2) % 3]));
  }
  return columns;
}

bool is_quantity(const Log& log, const std::string& header) {
  const auto time = files::find_quantity(log.flight(), "time", UnitKind::time);
  return (time && time->column->header == header) ||
         std::ranges::find(log.columns(), header, &LoggedColumn::header) != log.columns().end();
}

std::string unit_of_channel(const std::string& header) {
  const std::size_t split = header.rfind('_');
  return split == std::string::npos ? "" : header.substr(split + 1);
}

/// Whether a fit of the model measures it, row by row.
bool is_measured(const Log& log, const LoggedColumn& column) {
  if (!column.used() || column.quantity->taken == probes::Taken::as_known) return false;
  return std::ranges::none_of(column.quantity->unless, [&](std::string_view other) {
    return !other.empty() && log.find(other) != nullptr;
  });
}

}  // namespace

Role role_of(const Log& log, const LoggedColumn& column) {
  if (log.looks_at() == probes::LooksAt::trajectory) return Role::integrated;
  return is_measured(log, column) ? Role::measured : Role::driver;
}

std::vector<SuspectColumn> find_suspects(const Log& log) {
  const std::vector<Segment> stretches = find_stretches_of(log);
  std::vector<SuspectColumn> columns = find_in_quantities(log, stretches);
  for (const Flight::Column& channel : log.flight().columns()) {
    if (is_quantity(log, channel.header)) continue;
    const Manner manner = manner_of_channel(channel.header);
    columns.push_back({channel.header, unit_of_channel(channel.header), Role::driver, manner,
                       find_suspect_rows(channel.values, stretches, manner)});
  }
  std::erase_if(columns, [](const SuspectColumn& column) { return column.rows.empty(); });
  return columns;
}

std::vector<std::string> leave_out(const Log& log, const RowList& rows) {
  const auto time = files::find_quantity(log.flight(), "time", UnitKind::time);
  std::vector<std::string> conditions;
  if (!time) return conditions;
  const std::string name = quote(time->column->header);
  for (const Segment& run : find_runs_of(rows)) {
    const double first = time->column->values[run.first];
    const double last = time->column->values[run.last - 1];
    conditions.push_back(run.rows() == 1 ? fmt::format("{} != {}", name, first)
                                         : fmt::format("not ({} <= {} <= {})", first, name, last));
  }
  return conditions;
}

std::vector<std::string> leave_out(const Log& log, const SuspectColumn& column) {
  std::vector<std::string> conditions;
  for (const double code : column.rows.codes) {
    conditions.push_back(fmt::format("{} != {}", quote(column.header), code));
  }
  const RowList rest = join(join(column.rows.spikes, column.rows.bursts), column.rows.frozen);
  std::ranges::move(leave_out(log, rest), std::back_inserter(conditions));
  return conditions;
}

}  // namespace sepcal::checks
