// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logs/gps_time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string_view>

#include "flight/files/headers.hpp"
#include "flight/files/known_names.hpp"
#include "sepcal/detail/quantity.hpp"

namespace sepcal::logs {
namespace {

constexpr double week = 604'800.0;  // s

/// The first column whose header, in any case and however its words are parted, is one of these.
template <std::size_t size>
const Flight::Column* find_called(const Flight& flight,
                                  const std::array<std::string_view, size>& names) {
  const auto found = std::ranges::find_if(flight.columns(), [&](const Flight::Column& column) {
    const std::string letters = files::join_words(files::split_words(column.header));
    return std::ranges::find(names, letters) != names.end();
  });
  return found == flight.columns().end() ? nullptr : &*found;
}

/// A column of times of week [s].
struct TimeOfWeek {
  const Flight::Column* column = nullptr;
  double second = 1.0;  // in the column's unit
  bool is_guessed = false;
};

/// The unit that a time of week without one is in, by its size and its steps: nothing where both
/// would do.
std::optional<double> guess_second(const Flight::Column& column) {
  constexpr double longest_step = 2.0;  // s from row to row
  constexpr double milli = 1000.0;
  double largest = 0.0;
  double step = 0.0;
  double before = not_a_number;
  for (const double value : column.values) {
    if (!std::isfinite(value)) continue;
    largest = std::max(largest, value);
    if (step == 0.0 && value > before) step = value - before;
    before = value;
  }
  if (largest > week) return largest <= week * milli ? std::optional(milli) : std::nullopt;
  return step > 0.0 && step <= longest_step ? std::optional(1.0) : std::nullopt;
}

std::optional<TimeOfWeek> find_time_of_week(const Flight& flight) {
  if (const auto logged = files::find_quantity(flight, "gps_tow", files::UnitKind::time)) {
    return TimeOfWeek{logged->column, 1.0 / logged->unit->convert(1.0)};
  }
  constexpr std::array<std::string_view, 2> milliseconds{"gms", "itow"};
  if (const Flight::Column* column = find_called(flight, milliseconds)) {
    return TimeOfWeek{column, 1000.0};
  }
  constexpr std::array<std::string_view, 4> without_unit{"tow", "gpstow", "timeofweek",
                                                         "gpstimeofweek"};
  const Flight::Column* column = find_called(flight, without_unit);
  const auto second = column == nullptr ? std::nullopt : guess_second(*column);
  return second ? std::optional(TimeOfWeek{column, *second, true}) : std::nullopt;
}

}  // namespace

void derive_time(Flight& flight, std::vector<std::string>& notes) {
  if (flight.is_mapped() || files::find_quantity(flight, "time", files::UnitKind::time)) return;
  const auto tow = find_time_of_week(flight);
  if (!tow) return;
  constexpr std::array<std::string_view, 4> week_names{"gpsweek", "gwk", "week", "gpsweekno"};
  const Flight::Column* weeks = find_called(flight, week_names);
  std::vector<double> time;
  std::optional<Flight::Cell> none;
  double first_week = not_a_number;
  double turns = 0.0;
  double before = not_a_number;
  for (std::size_t row = 0; row < flight.rows(); ++row) {
    const double seconds = tow->column->values[row] / tow->second;
    double weeks_on = turns;
    if (weeks != nullptr) {
      if (std::isnan(first_week)) first_week = weeks->values[row];
      weeks_on = weeks->values[row] - first_week;
    } else if (seconds < before - week / 2) {
      weeks_on = ++turns;
    }
    if (std::isfinite(seconds)) before = seconds;
    time.push_back(week * weeks_on + seconds);
    if (!none && !std::isfinite(time.back())) none = Flight::Cell{row, "no GPS time"};
  }
  notes.push_back(fmt::format("{}: time is {}{}{}, in seconds", flight.name(),
                              tow->column->logged_header(),
                              weeks == nullptr ? "" : " and " + weeks->logged_header(),
                              !tow->is_guessed     ? ""
                              : tow->second == 1.0 ? ", taken for seconds"
                                                   : ", taken for milliseconds"));
  const auto owned = std::make_shared<const std::vector<double>>(std::move(time));
  flight.view("time_s", *owned, owned, std::move(none));
}

}  // namespace sepcal::logs
