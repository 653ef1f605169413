// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>

#include "base/gaps.hpp"
#include "flight/files/headers.hpp"
#include "flight/files/sha256.hpp"
#include "flight/joint/own_by_flight.hpp"
#include "flight/logs/chosen_columns.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/joint.hpp"

namespace sepcal {

using namespace joint;  // this room's own

namespace {

/// The header under which a flight has its time, and a second in its unit. `choice` says what is
/// called otherwise.
struct TimeColumn {
  std::string header;
  double second = 1.0;
};

TimeColumn find_time(const Flight& flight, const LogChoice& choice) {
  Flight named = flight;
  logs::choose_columns(named, choice);
  const auto logged = files::find_quantity(named, "time", files::UnitKind::time);
  if (!logged) {
    throw Error(
        fmt::format("{}: there is no column of time; flights are joined by it", flight.name()));
  }
  std::string header = logged->column->header;
  if (const auto mapped = choice.map.find(header); mapped != choice.map.end()) {
    header = mapped->second;
  }
  return {std::move(header), 1.0 / logged->unit->convert(1.0)};
}

void check_flights(const std::vector<Flight>& flights) {
  if (flights.size() < 2) throw Error("a joint fit takes two flights or more");
  std::set<std::string> names;
  for (const Flight& flight : flights) {
    if (flight.is_mapped()) throw Error("a streamed log can't be fitted jointly");
    if (flight.rows() == 0) throw Error(flight.name() + ": there are no rows");
    if (!names.insert(flight.name()).second) {
      throw Error(fmt::format("{} is given twice; give each flight once", flight.name()));
    }
  }
}

/// What of each flight's time is added, so that each begins after the one before has ended.
std::vector<double> find_offsets(const std::vector<Flight>& flights, const TimeColumn& time) {
  double gap = time.second;
  const auto values_of = [&](const Flight& flight) { return flight.find(time.header)->values; };
  for (const Flight& flight : flights) {
    std::vector<double> intervals;
    const auto values = values_of(flight);
    for (std::size_t i = 1; i < values.size(); ++i) {
      if (values[i] > values[i - 1]) intervals.push_back(values[i] - values[i - 1]);
    }
    if (!intervals.empty()) gap = std::max(gap, 2.0 * base::find_gap(std::move(intervals)));
  }
  std::vector<double> offsets;
  double last = -infinity;
  for (const Flight& flight : flights) {
    double first = infinity;
    double latest = -infinity;
    for (const double value : values_of(flight)) {
      if (!std::isfinite(value)) continue;
      first = std::min(first, value);
      latest = std::max(latest, value);
    }
    offsets.push_back(first >= last + gap ? 0.0 : last + gap - first);
    last = std::max(last, latest + offsets.back());
  }
  return offsets;
}

/// Headers that all flights have; a note names the others.
std::vector<std::string> common_headers(const std::vector<Flight>& flights,
                                        std::vector<std::string>& notes) {
  std::vector<std::string> common;
  std::set<std::string> others;
  for (const Flight& flight : flights) {
    for (const Flight::Column& column : flight.columns()) {
      const bool everywhere = std::ranges::all_of(
          flights, [&](const Flight& other) { return other.find(column.header) != nullptr; });
      if (!everywhere) {
        others.insert(fmt::format("{} ({})", column.header, flight.name()));
      } else if (&flight == &flights.front()) {
        common.push_back(column.header);
      }
    }
  }
  if (!others.empty()) {
    notes.push_back(
        fmt::format("columns that not every flight has are left out: {}", fmt::join(others, ", ")));
  }
  return common;
}

std::string hash_of(const std::vector<Flight>& flights) {
  files::Sha256 hash;
  for (const Flight& flight : flights) {
    if (flight.sha256().empty()) return "";
    hash.absorb(flight.sha256().data(), flight.sha256().size());
  }
  return hash.finish();
}

}  // namespace

std::vector<JoinedFlight> describe_flights(const std::vector<Flight>& flights) {
  std::vector<std::string> stems;
  for (const Flight& flight : flights) {
    stems.push_back(std::filesystem::path(flight.name()).stem().string());
  }
  const bool differ = std::set(stems.begin(), stems.end()).size() == stems.size();
  std::vector<JoinedFlight> described;
  for (std::size_t k = 0; k < flights.size(); ++k) {
    described.push_back({.label = differ ? stems[k] : flights[k].name(),
                         .file = flights[k].name(),
                         .sha256 = flights[k].sha256(),
                         .rows = flights[k].rows()});
  }
  return described;
}

Flight join_flights(const std::vector<Flight>& flights, const LogChoice& choice,
                    std::vector<std::string>& notes) {
  check_flights(flights);
  const TimeColumn time = find_time(flights.front(), choice);
  const std::vector<std::string> headers = common_headers(flights, notes);
  if (std::ranges::find(headers, time.header) == headers.end()) {
    throw Error(
        fmt::format("not every flight has its time as {}; rename it in the others", time.header));
  }
  const std::vector<double> offsets = find_offsets(flights, time);
  std::vector<std::string> names;
  std::vector<Flight::Part> parts;
  std::size_t rows = 0;
  bool labelled = false;
  for (const Flight& flight : flights) {
    names.push_back(flight.name());
    parts.push_back({flight.name(), rows});
    rows += flight.rows();
    labelled = labelled || !flight.maneuvers().empty();
  }
  Flight joined(fmt::format("{}", fmt::join(names, " + ")), hash_of(flights));
  for (const std::string& header : headers) {
    if (header == flight_number) continue;
    std::vector<double> values;
    values.reserve(rows);
    std::optional<Flight::Cell> text;
    for (std::size_t k = 0; k < flights.size(); ++k) {
      const Flight::Column& column = *flights[k].find(header);
      if (column.first_text && !text) {
        text = Flight::Cell{values.size() + column.first_text->row, column.first_text->text};
      }
      const double offset = header == time.header ? offsets[k] : 0.0;
      for (const double value : column.values) values.push_back(value + offset);
    }
    const auto owned = std::make_shared<const std::vector<double>>(std::move(values));
    joined.view(header, *owned, owned, std::move(text));
  }
  std::vector<double> numbers;
  std::vector<std::string> labels;
  const std::vector<JoinedFlight> described = describe_flights(flights);
  for (std::size_t k = 0; k < flights.size(); ++k) {
    const auto own = flights[k].maneuvers();
    numbers.insert(numbers.end(), flights[k].rows(), static_cast<double>(k));
    labels.insert(labels.end(), own.begin(), own.end());
    labels.resize(numbers.size(), described[k].label);
  }
  joined.add(flight_number, std::move(numbers));
  if (labelled) joined.label(std::move(labels));
  joined.join(std::move(parts));
  return joined;
}

}  // namespace sepcal
