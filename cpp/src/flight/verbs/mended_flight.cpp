// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/mended_flight.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "flight/checks/samples.hpp"
#include "flight/checks/suspect_notes.hpp"
#include "flight/checks/suspects.hpp"
#include "flight/checks/taken_rows.hpp"
#include "flight/files/headers.hpp"

namespace sepcal::verbs {
namespace {

using checks::join;
using checks::Log;
using checks::Role;
using checks::RowList;
using checks::SuspectColumn;

/// Rows of the column that hold no number, of those taken; none where they are many or the column
/// is no column of numbers at all.
RowList find_empty(const Flight::Column& column, const RowList& left_out) {
  RowList empty;
  for (std::size_t row = 0; row < column.values.size(); ++row) {
    if (!std::isfinite(column.values[row]) && !std::ranges::binary_search(left_out, row)) {
      empty.push_back(row);
    }
  }
  constexpr std::size_t fewest = 20;  // rows, of which a twentieth is one
  const std::size_t taken = column.values.size() - left_out.size();
  return taken < fewest || 20 * empty.size() > taken ? RowList() : empty;
}

/// On the line from the last good row to the next, by time where it was logged; beyond them, and of
/// an angle that began anew between (`turn`: a whole one, else 0), what the nearest before (else
/// after) holds.
std::vector<double> bridge(std::span<const double> values, const RowList& bad,
                           std::span<const double> time, double turn) {
  std::vector<double> mended(values.begin(), values.end());
  const auto at = [&](std::size_t row) {
    return time.empty() ? static_cast<double>(row) : time[row];
  };
  const auto is_good = [&](std::size_t row) {
    return std::isfinite(values[row]) && !std::ranges::binary_search(bad, row);
  };
  const auto begins_anew = [&](std::size_t before, std::size_t after) {
    return turn > 0 && std::abs(values[after] - values[before - 1]) > 0.5 * turn;
  };
  for (const Segment& run : checks::find_runs_of(bad)) {
    std::size_t before = run.first;
    while (before > 0 && !is_good(before - 1)) --before;  // the row after the last good one
    std::size_t after = run.last;
    while (after < values.size() && !is_good(after)) ++after;
    if (before == 0 && after == values.size()) continue;
    for (std::size_t row = run.first; row < run.last; ++row) {
      if (before == 0 || after == values.size() || begins_anew(before, after)) {
        mended[row] = before == 0 ? values[after] : values[before - 1];
        continue;
      }
      const double share = (at(row) - at(before - 1)) / (at(after) - at(before - 1));
      mended[row] = values[before - 1] + share * (values[after] - values[before - 1]);
    }
  }
  return mended;
}

/// "20 with the code -9999, 3 without a number"
std::string say_why(const SuspectColumn* suspect, const RowList& empty) {
  std::vector<std::string> reasons;
  const auto add = [&](const RowList& rows, const std::string& what) {
    if (!rows.empty()) reasons.push_back(fmt::format("{} {}", rows.size(), what));
  };
  if (suspect != nullptr) {
    const checks::SuspectRows& rows = suspect->rows;
    add(rows.sentinels, fmt::format("with the code {}", fmt::join(rows.codes, " or ")));
    add(rows.spikes, "that jump away alone");
    add(rows.bursts, "that jump away in a burst");
    add(rows.frozen, "that stand still where others change");
  }
  add(empty, "without a number");
  return fmt::format("{}", fmt::join(reasons, ", "));
}

/// Whether the column's readings are none in rows that pull an answer.
bool is_serious(const SuspectColumn& column) {
  const checks::SuspectRows& rows = column.rows;
  return column.role == Role::measured && (!rows.sentinels.empty() || !rows.bursts.empty() ||
                                           !rows.frozen.empty() || checks::is_heavy(rows));
}

/// Conditions of several columns, each once.
class Conditions {
 public:
  void add(const std::string& header, const std::vector<std::string>& conditions) {
    columns_ += (columns_.empty() ? "" : ", ") + header;
    for (const std::string& condition : conditions) {
      if (std::ranges::find(all_, condition) == all_.end()) all_.push_back(condition);
    }
  }
  RowsToLeave join() const {
    return all_.empty() ? RowsToLeave() : RowsToLeave{checks::join_conditions("", all_), columns_};
  }

 private:
  std::vector<std::string> all_;
  std::string columns_;
};

/// Whether a value between its neighbours will do in the column.
bool can_be_bridged(const Log& log, const Flight::Column& column) {
  const auto time = files::find_quantity(log.flight(), "time", files::UnitKind::time);
  if (time && time->column->header == column.header) return false;
  const auto read = std::ranges::find(log.columns(), column.header, &checks::LoggedColumn::header);
  return read == log.columns().end() || checks::role_of(log, *read) != Role::measured;
}

/// Whether no fit needs a number in each cell.
bool may_be_empty(const Log& log, const Flight::Column& column) {
  const auto read = std::ranges::find(log.columns(), column.header, &checks::LoggedColumn::header);
  return read == log.columns().end() || !read->used() || read->name() == "temp";
}

}  // namespace

MendedFlight mend(const probes::ModelQuantities& model, const Flight& flight,
                  const LogChoice& choice) {
  MendedFlight mended{flight};
  if (flight.is_mapped()) return mended;
  const checks::TakenRows taken = checks::take_rows(model, flight, choice);
  const Log log(model, taken.flight);
  const std::vector<SuspectColumn> suspects = checks::find_suspects(log);
  for (const Flight::Column& column : flight.columns()) {
    if (!can_be_bridged(log, column)) continue;
    const auto suspect = std::ranges::find(suspects, column.header, &SuspectColumn::header);
    const SuspectColumn* found = suspect == suspects.end() ? nullptr : &*suspect;
    const RowList empty =
        may_be_empty(log, column) ? find_empty(column, taken.left_out) : RowList();
    const RowList bad = found == nullptr ? empty : join(found->rows.all(), empty);
    if (bad.empty()) continue;
    const double turn = found == nullptr ? 0.0 : found->manner.turn;
    mended.flight.replace(column.header, bridge(column.values, bad, log.time(), turn));
    auto& notes = found == nullptr ? mended.filled : mended.bridged;
    notes.push_back(fmt::format(
        "{}: column '{}' has no reading in {} of {} rows, first at {} ({}): an effect takes the "
        "value between its neighbours there",
        flight.name(), column.header, bad.size(), flight.rows() - taken.left_out.size(),
        checks::name_row(log, bad.front()), say_why(found, empty)));
  }
  Conditions measured;
  Conditions all;
  for (const SuspectColumn& column : suspects) {
    if (is_serious(column)) {
      mended.loss_helps &= column.rows.sentinels.empty() && column.rows.frozen.empty();
      measured.add(column.header, checks::leave_out(log, column));
      all.add(column.header, checks::leave_out(log, column));
    } else if (column.role != Role::measured && !column.rows.frozen.empty()) {
      all.add(column.header, checks::leave_out(log, column.rows.frozen));
    }
  }
  mended.slow = checks::find_slowest(log);
  mended.measured = measured.join();
  mended.all = all.join();
  return mended;
}

}  // namespace sepcal::verbs
