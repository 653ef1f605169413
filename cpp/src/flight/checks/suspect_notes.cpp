// SPDX-License-Identifier: BSD-3-Clause
#include "flight/checks/suspect_notes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace sepcal::checks {
namespace {

/// What rows that are no readings do.
std::string say_effect(const SuspectColumn& column, std::string_view on_measured) {
  if (column.role == Role::measured) return std::string(on_measured);
  if (column.role == Role::integrated) return "the value between its neighbours stands in there";
  return "no effect follows it there: the value between its neighbours stands in";
}

std::string say_size(double size, const std::string& unit) {
  return fmt::format("{:.3g}{}{}", size, unit.empty() ? "" : " ", unit);
}

std::string say_rows(const RowList& rows) {
  return rows.size() == 1 ? "1 row" : fmt::format("{} rows", rows.size());
}

/// A condition to type, where few enough of them do; else nothing.
std::string way_out(const LogChoice& choice, const std::vector<std::string>& conditions) {
  constexpr std::size_t most = 8;
  if (conditions.empty() || conditions.size() > most) return "";
  return fmt::format("--where \"{}\"", join_conditions(choice.where, conditions));
}

std::string advise(const SuspectColumn& column, const std::string& condition,
                   std::string_view loss) {
  if (column.role != Role::measured) {
    return condition.empty() ? "nothing else to do"
                             : "nothing else to do, or leave these rows out: " + condition;
  }
  const std::string leave = condition.empty() ? "take them out" : "leave them out: " + condition;
  return loss.empty() ? leave : fmt::format("{}, or fit with --loss {}", leave, loss);
}

/// Whether a probe takes none of these rows anyway, as nothing flows into its tube there.
bool flows_nowhere(const Log& log, const SuspectColumn& column, const RowList& rows) {
  if (log.looks_at() != probes::LooksAt::readings) return false;
  return std::ranges::any_of(std::array{"airspeed", "dp"}, [&](const char* quantity) {
    const LoggedColumn* const reading = log.find(quantity);
    return reading != nullptr && reading->used() && reading->header() == column.header &&
           std::ranges::all_of(rows, [&](std::size_t row) { return reading->values[row] <= 0.0; });
  });
}

void note_sentinels(const Log& log, const SuspectColumn& column, const LogChoice& choice,
                    std::vector<LogNote>& notes) {
  const RowList& rows = column.rows.sentinels;
  if (rows.empty()) return;
  LogNote note = note_on(log, "sentinels", Concern::matters, {column.header}, rows);
  note.found = fmt::format("{}: {} hold{} {}, a code and no reading, first at {}", column.header,
                           say_rows(rows), rows.size() == 1 ? "s" : "",
                           fmt::join(column.rows.codes, " or "), name_row(log, rows.front()));
  const bool left_out =
      column.role == Role::measured && (leaves_codes_out(log) || flows_nowhere(log, column, rows));
  note.effect = left_out
                    ? "these rows are left out"
                    : say_effect(column, "a fit takes it for a reading, diagnose and add don't");
  const Role role = left_out ? Role::driver : column.role;
  SuspectColumn codes{column.header, column.unit, role, column.manner, {}};
  codes.rows.codes = column.rows.codes;
  note.advice = advise(codes, way_out(choice, leave_out(log, codes)), "");
  notes.push_back(std::move(note));
}

void note_spikes(const Log& log, const SuspectColumn& column, const LogChoice& choice,
                 std::vector<LogNote>& notes) {
  const RowList& rows = column.rows.spikes;
  if (rows.empty()) return;
  const double share = column.rows.spike_share;
  const bool heavy = is_heavy(column.rows);
  const bool matters = heavy || column.role == Role::integrated;
  LogNote note =
      note_on(log, "outliers", matters ? Concern::matters : Concern::slight, {column.header}, rows);
  note.found =
      fmt::format("{} jumps for {} single reading{}, by up to {}, first at {}", column.header,
                  rows.size(), rows.size() == 1 ? "" : "s",
                  say_size(column.rows.farthest_spike, column.unit), name_row(log, rows.front()));
  note.effect = say_effect(
      column,
      heavy ? fmt::format("they make {:.0f} % of the squared differences between neighbouring "
                          "readings: estimates move and standard errors grow; diagnose and add "
                          "leave them out",
                          100 * share)
            : "each pulls the estimates a little");
  note.advice = advise(column, way_out(choice, leave_out(log, rows)), "huber");
  notes.push_back(std::move(note));
}

/// Whether the note of the same rows of another column is there, which then is of both: a receiver
/// that was wrong in all that it logs.
bool joins_another(const LogNote& note, const std::string& header, std::vector<LogNote>& notes) {
  const auto before = std::ranges::find_if(notes, [&](const LogNote& other) {
    return other.kind == note.kind && other.rows == note.rows && other.first_s == note.first_s &&
           other.last_s == note.last_s && other.concern == note.concern;
  });
  if (before == notes.end()) return false;
  before->columns.push_back(header);
  before->found = list_headers(before->columns) + before->found.substr(before->found.find(':'));
  return true;
}

void note_bursts(const Log& log, const SuspectColumn& column, const LogChoice& choice,
                 std::vector<LogNote>& notes) {
  const RowList& rows = column.rows.bursts;
  if (rows.empty()) return;
  const std::size_t count = find_runs_of(rows).size();
  LogNote note = note_on(log, "glitches", Concern::matters, {column.header}, rows);
  if (joins_another(note, column.header, notes)) return;
  note.found =
      fmt::format("{}: {} jump away and come back, in {} burst{}, by up to {}, first at {}",
                  column.header, say_rows(rows), count, count == 1 ? "" : "s",
                  say_size(column.rows.farthest_burst, column.unit), name_row(log, rows.front()));
  note.effect =
      say_effect(column, "a fit takes them for readings and is pulled, diagnose and add don't");
  note.advice = advise(column, way_out(choice, leave_out(log, rows)), "cauchy");
  notes.push_back(std::move(note));
}

void note_frozen(const Log& log, const SuspectColumn& column, const LogChoice& choice,
                 std::vector<LogNote>& notes) {
  const RowList& rows = column.rows.frozen;
  if (rows.empty()) return;
  LogNote note = note_on(log, "frozen", Concern::matters, {column.header}, rows);
  if (log.flight().find(column.header)->values[rows.front()] == 0.0 &&
      joins_another(note, column.header, notes)) {
    return;
  }
  note.found = fmt::format(
      "{}: {} stand still at {}, where others change, first at {}", column.header, say_rows(rows),
      say_size(log.flight().find(column.header)->values[rows.front()], column.unit),
      name_row(log, rows.front()));
  SuspectColumn frozen = column;
  if (frozen.role == Role::integrated) frozen.role = Role::measured;  // too long to be bridged
  note.effect =
      say_effect(frozen, column.role == Role::integrated
                             ? "a fit takes what lies between the rows beside them, and is pulled; "
                               "diagnose and add leave them out"
                             : "a fit takes them for readings and is pulled, diagnose and add "
                               "don't");
  note.advice = advise(frozen, way_out(choice, leave_out(log, rows)), "");
  notes.push_back(std::move(note));
}

}  // namespace

std::string join_conditions(const std::string& where, std::vector<std::string> conditions) {
  if (!where.empty()) conditions.insert(conditions.begin(), "(" + where + ")");
  return fmt::format("{}", fmt::join(conditions, " and "));
}

void check_suspects(const Log& log, const std::vector<SuspectColumn>& suspects,
                    const LogChoice& choice, std::vector<LogNote>& notes) {
  for (const SuspectColumn& column : suspects) {
    note_sentinels(log, column, choice, notes);
    note_spikes(log, column, choice, notes);
    note_bursts(log, column, choice, notes);
    note_frozen(log, column, choice, notes);
  }
}

void check_constants(const Log& log, std::vector<LogNote>& notes) {
  constexpr std::array readings{"mx", "my", "mz", "airspeed", "dp", "pt", "dpa", "dpb"};
  constexpr std::array or_unused{"ax", "ay", "az", "p", "q", "r", "alpha", "beta"};  // at zero
  for (const LoggedColumn& column : log.columns()) {
    const std::span<const double> values = column.logged.column->values;
    const bool reads =
        std::ranges::find(readings, column.name()) != readings.end() ||
        (std::ranges::find(or_unused, column.name()) != or_unused.end() && values.front() != 0);
    if (!reads || !column.used() || !is_constant(values)) continue;
    LogNote note = note_on(log, "frozen", Concern::wrong, {column.header()});
    note.found = fmt::format("{} reads {} in every row", column.header(),
                             say_size(values.front(), std::string(column.logged.unit->suffix)));
    note.effect =
        "a reading that never changes can't be calibrated: the sensor is blocked or not connected";
    note.advice = "mend the sensor or the logging, and fly again";
    notes.push_back(std::move(note));
  }
  const LoggedColumn* north = log.find("vn");
  const LoggedColumn* east = log.find("ve");
  if (north == nullptr || east == nullptr) return;
  const bool still = is_constant(north->logged.column->values);
  const LoggedColumn& one = still ? *north : *east;
  const LoggedColumn& other = still ? *east : *north;
  const double value = one.logged.column->values.empty() ? 0.0 : one.logged.column->values.front();
  if (value == 0 || !is_constant(one.logged.column->values) ||
      is_constant(other.logged.column->values)) {
    return;
  }
  LogNote note = note_on(log, "frozen", Concern::wrong, {one.header()});
  note.found = fmt::format("{} reads {} in every row, while {} changes", one.header(),
                           say_size(value, std::string(one.logged.unit->suffix)), other.header());
  note.effect = "half of the velocity is missing: the wind and the scale come out wrong";
  note.advice = "mend the receiver or the logging, and fly again";
  notes.push_back(std::move(note));
}

}  // namespace sepcal::checks
