// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>

#include "base/gaps.hpp"
#include "flight/files/headers.hpp"
#include "flight/files/sha256.hpp"
#include "flight/joint/own_by_flight.hpp"
#include "flight/logs/chosen_columns.hpp"
#include "flight/logs/gps_time.hpp"
#include "flight/logs/named_columns.hpp"
#include "sepcal/detail/flight/joint.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace joint;  // this room's own

namespace {

constexpr std::array kinds{
    files::UnitKind::time,     files::UnitKind::angle,       files::UnitKind::rate,
    files::UnitKind::length,   files::UnitKind::speed,       files::UnitKind::acceleration,
    files::UnitKind::pressure, files::UnitKind::temperature, files::UnitKind::density,
    files::UnitKind::field,    files::UnitKind::share};

/// "roll_deg" as a quantity and its unit; nothing of a header without a unit that is known.
struct Headed {
  std::string quantity;
  const files::Unit* unit = nullptr;
};

std::optional<Headed> parse_header(const std::string& header) {
  for (const files::UnitKind kind : kinds) {
    for (const files::Unit& unit : files::known_units(kind)) {
      const std::string ending = "_" + std::string(unit.suffix);
      if (header.size() > ending.size() && header.ends_with(ending)) {
        return Headed{header.substr(0, header.size() - ending.size()), &unit};
      }
    }
  }
  return std::nullopt;
}

/// What of the choice's map and ignored columns is of this flight's columns; the rest is of
/// others'.
LogChoice names_for(const LogChoice& choice, const Flight& flight) {
  LogChoice own{.map = choice.map, .ignore = choice.ignore};
  std::erase_if(own.map,
                [&](const auto& names) { return !logs::find_mapped(flight, names.second); });
  std::erase_if(own.ignore, [&](const std::string& header) {
    return flight.find(header) == nullptr && !own.map.contains(header);
  });
  return own;
}

/// Throws OptionError for a choice of columns that no flight has.
void check_names(const LogChoice& choice, const std::vector<Flight>& flights) {
  const auto nobody_has = [&](const std::string& header) {
    return std::ranges::all_of(
        flights, [&](const Flight& flight) { return flight.find(header) == nullptr; });
  };
  for (const auto& [header, logged] : choice.map) {
    const bool is_somewhere = std::ranges::any_of(flights, [&](const Flight& flight) {
      return logs::find_mapped(flight, logged).has_value();
    });
    if (is_somewhere) continue;
    throw OptionError({Option{"map"},
                       fmt::format(" {}={}: no flight has a column '{}'", header, logged, logged)});
  }
  for (const std::string& header : choice.ignore) {
    if (!nobody_has(header) || choice.map.contains(header)) continue;
    throw OptionError({Option{"ignore"}, fmt::format(" {}: no flight has such a column", header)});
  }
}

/// A flight under the names of the choice and, where a column of `first` is there in another unit,
/// in that one.
Flight align(const Flight& flight, const LogChoice& choice, const Flight* first,
             std::vector<std::string>& notes) {
  Flight aligned = flight;
  logs::choose_columns(aligned, names_for(choice, flight), notes);
  logs::name_columns(aligned, notes);
  logs::derive_time(aligned, notes);
  if (first == nullptr) return aligned;
  for (const Flight::Column& column : first->columns()) {
    if (aligned.find(column.header) != nullptr) continue;
    const auto headed = parse_header(column.header);
    if (!headed) continue;
    const auto found = files::find_quantity(aligned, headed->quantity, headed->unit->kind);
    if (!found) continue;
    std::vector<double> values = found->values();
    const double none = headed->unit->convert(0.0);
    const double one = headed->unit->convert(1.0) - none;
    for (double& value : values) value = (value - none) / one;
    const std::string before = found->column->header;
    aligned.rename(before, column.header);
    aligned.replace(column.header, std::move(values));
  }
  return aligned;
}

/// The header under which a flight has its time, and a second in its unit.
struct TimeColumn {
  std::string header;
  double second = 1.0;
};

TimeColumn find_time(const Flight& flight) {
  const auto logged = files::find_quantity(flight, "time", files::UnitKind::time);
  if (!logged) {
    throw Error(fmt::format("{}: there is no column of time, as time_s; flights are joined by it",
                            flight.name()));
  }
  return {logged->column->header, 1.0 / logged->unit->convert(1.0)};
}

void check_flights(const std::vector<Flight>& flights, const LogChoice& choice) {
  if (flights.size() < 2) throw Error("a joint fit takes two flights or more");
  if (choice.from_time || choice.to_time) {
    throw OptionError({Option{choice.from_time ? "from_time" : "to_time"},
                       " is of one clock, and each flight has its own; choose rows of several "
                       "flights by ",
                       Option{"where"}, " or by labels"});
  }
  for (std::size_t k = 0; k < flights.size(); ++k) {
    const Flight& flight = flights[k];
    if (flight.is_mapped()) {
      throw OptionError({Option{"stream"},
                         ": streamed logs can't be fitted jointly; leave it out, or fit them one "
                         "by one"});
    }
    if (flight.rows() == 0) throw Error(flight.name() + ": there are no rows");
    for (std::size_t i = 0; i < k; ++i) {
      const bool same_bytes = !flight.sha256().empty() && flight.sha256() == flights[i].sha256();
      if (!same_bytes && flights[i].name() != flight.name()) continue;
      throw Error(flights[i].name() == flight.name()
                      ? flight.name() + " is given twice; give each flight once"
                      : fmt::format("{} and {} are the same file; give each flight once",
                                    flights[i].name(), flight.name()));
    }
  }
}

/// What of each flight's time is added, so that each begins after the one before has ended, and
/// within a day: clocks that are farther apart have nothing to do with each other.
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
    const double day = 86'400.0 * time.second;
    const bool follows = offsets.empty() || (first >= last + gap && first <= last + day);
    offsets.push_back(follows ? 0.0 : last + gap - first);
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

Flight join_flights(const std::vector<Flight>& given, const LogChoice& choice,
                    std::vector<std::string>& notes) {
  check_flights(given, choice);
  check_names(choice, given);
  std::vector<Flight> flights;
  for (const Flight& flight : given) {
    flights.push_back(align(flight, choice, flights.empty() ? nullptr : &flights.front(), notes));
  }
  const TimeColumn time = find_time(flights.front());
  const std::vector<std::string> headers = common_headers(flights, notes);
  for (const Flight& flight : flights) {
    if (flight.find(time.header) != nullptr) continue;
    throw Error(fmt::format("{}: there is no column {}; flights are joined by their time",
                            flight.name(), time.header));
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
