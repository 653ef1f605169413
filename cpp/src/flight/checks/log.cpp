// SPDX-License-Identifier: BSD-3-Clause
#include "flight/checks/log.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "flight/checks/turns.hpp"
#include "numerics/order_statistics.hpp"

namespace sepcal::checks {

using files::UnitKind;

Log::Log(const probes::ModelQuantities& model, const Flight& flight)
    : looks_at_(model.looks_at), flight_(flight) {
  time_ = files::read_quantity(flight, "time", UnitKind::time);
  stretches_ = probes::find_stretches(time_, flight.maneuvers());
  for (const probes::ProbeQuantity& quantity : model.list) {
    if (quantity.kind == UnitKind::time) continue;
    const auto logged = files::find_quantity(flight, quantity.name, quantity.kind, quantity.bare);
    if (!logged) continue;
    LoggedColumn column{&quantity, *logged, logged->values(), {}};
    if (quantity.kind == UnitKind::angle) unwrap(column.values, 2 * std::numbers::pi);
    column.sequence = probes::find_sequence(logged->column->values, stretches_);
    columns_.push_back(std::move(column));
  }
}

double Log::interval() const {
  double seconds = 0.0;
  double steps = 0.0;
  for (const Segment& stretch : stretches_) {
    seconds += time_[stretch.last - 1] - time_[stretch.first];
    steps += static_cast<double>(stretch.rows() - 1);
  }
  return steps == 0.0 ? not_a_number : seconds / steps;
}

const LoggedColumn* Log::find(std::string_view quantity) const {
  const auto found = std::ranges::find(columns_, quantity, &LoggedColumn::name);
  return found == columns_.end() ? nullptr : &*found;
}

std::vector<const LoggedColumn*> Log::find_all(
    std::initializer_list<std::string_view> names) const {
  std::vector<const LoggedColumn*> found;
  for (const std::string_view name : names) {
    const LoggedColumn* column = find(name);
    if (column == nullptr) return {};
    found.push_back(column);
  }
  return found;
}

LogNote note_on(const Log& log, std::string_view kind, Concern concern,
                std::vector<std::string> columns, std::span<const std::size_t> rows) {
  LogNote note{.kind = std::string(kind), .concern = concern, .columns = std::move(columns)};
  note.rows = rows.empty() ? log.flight().rows() : rows.size();
  if (rows.empty() || log.time().empty()) return note;
  note.first_s = log.time()[rows.front()];
  note.last_s = log.time()[rows.back()];
  return note;
}

std::string in_one_line(const LogNote& note, const std::string& file) {
  return fmt::format("{}: {}; {}; {}", file, note.found, note.effect, note.advice);
}

std::string name_row(const Log& log, std::size_t row) {
  const std::string place = log.flight().locate(row);
  const std::string name = log.flight().name() + " ";
  return place.starts_with(name) ? place.substr(name.size()) : place;  // of flights joined: in one
}

std::string list_headers(const std::vector<std::string>& headers) {
  return fmt::format("{}", fmt::join(headers, ", "));
}

double median(std::vector<double> values) {
  if (values.empty()) return not_a_number;
  return numerics::select_quantile(values, 0.5);
}

}  // namespace sepcal::checks
