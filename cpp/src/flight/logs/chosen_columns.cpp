// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logs/chosen_columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>

#include "base/name_list.hpp"
#include "base/spool.hpp"
#include "flight/files/headers.hpp"
#include "flight/files/known_names.hpp"
#include "sepcal/error.hpp"

namespace sepcal::logs {
namespace {

[[noreturn]] void fail(const Flight& flight, const char* option, const std::string& what) {
  throw OptionError({flight.name() + ": ", Option{option}, what});
}

bool is_ignored(const LogChoice& choice, const std::string& header) {
  return std::ranges::find(choice.ignore, header) != choice.ignore.end();
}

/// A pair of the map that renames or turns a column.
struct Change {
  std::string header;  // the new one
  MappedColumn from;
};

/// Throws OptionError for pairs that can't be followed.
std::vector<Change> changes_of(const Flight& flight, const LogChoice& choice) {
  std::vector<Change> changes;
  for (const auto& [header, logged] : choice.map) {
    if (header == "maneuver") {
      fail(flight, "map", " can't name labels: call that column maneuver in the file");
    }
    const auto from = find_mapped(flight, logged);
    if (!from) {
      fail(flight, "map",
           fmt::format(" {}={} names a column that is not there; {}", header, logged,
                       flight.list_columns()));
    }
    const auto twice = std::ranges::find(changes, from->header,
                                         [](const Change& change) { return change.from.header; });
    if (twice != changes.end()) {
      fail(flight, "map",
           fmt::format(" reads '{}' twice, as {} and as {}", from->header, twice->header, header));
    }
    changes.push_back({header, *from});
  }
  return changes;
}

/// Throws OptionError for a new name that a column has which keeps it.
void check_free(const Flight& flight, const std::vector<Change>& changes) {
  for (const Change& change : changes) {
    const Flight::Column* there = flight.find(change.header);
    if (there == nullptr || there->header != change.header) continue;
    const bool moves = std::ranges::any_of(
        changes, [&](const Change& other) { return other.from.header == change.header; });
    if (moves) continue;
    throw OptionError({flight.name() + ": ", Option{"map"},
                       fmt::format(" {}={}: there is a column '{}' already; ", change.header,
                                   change.from.header, change.header),
                       Option{"ignore"}, " " + change.header});
  }
}

void turn_sign(Flight& flight, const std::string& header) {
  const std::span<const double> values = flight.find(header)->values;
  if (!flight.is_mapped()) {
    std::vector<double> turned(values.begin(), values.end());
    for (double& value : turned) value = -value;
    flight.replace(header, std::move(turned));
    return;
  }
  base::Spool::Column turned(*flight.spool());
  for (const double value : values) turned.append(-value);
  flight.replace(header, turned.finish(), flight.spool());
}

/// An axis of a vector.
struct Axis {
  std::size_t vector;
  std::size_t axis;
};

constexpr std::array<std::array<std::string_view, 3>, 4> vectors{
    std::array<std::string_view, 3>{"mx", "my", "mz"},
    {"hx", "hy", "hz"},
    {"p", "q", "r"},
    {"ax", "ay", "az"}};
constexpr std::array vector_kinds{files::UnitKind::field, files::UnitKind::field,
                                  files::UnitKind::rate, files::UnitKind::acceleration};

std::optional<Axis> axis_of(const std::string& header) {
  for (std::size_t vector = 0; vector < vectors.size(); ++vector) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string_view name = vectors[vector][axis];
      if (files::unit_in(header, name, vector_kinds[vector]) != nullptr ||
          files::recognise(header, {name, vector_kinds[vector]})) {
        return Axis{vector, axis};
      }
    }
  }
  return std::nullopt;
}

/// Of each vector whose axes are turned by signed permutations alone, whether that is a mirror.
void note_mirrors(const Flight& flight, const std::vector<Change>& changes,
                  std::vector<std::string>& notes) {
  for (std::size_t vector = 0; vector < vectors.size(); ++vector) {
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    bool known = true;
    bool changed = false;
    for (const Change& change : changes) {
      const auto to = axis_of(change.header);
      if (!to || to->vector != vector) continue;
      const auto from = axis_of(change.from.header);
      known = known && from && from->vector == vector;
      if (!known) break;
      changed = true;
      turn.row(static_cast<Eigen::Index>(to->axis)).setZero();
      turn(static_cast<Eigen::Index>(to->axis), static_cast<Eigen::Index>(from->axis)) =
          change.from.is_negated ? -1.0 : 1.0;
    }
    if (!known || !changed || !(turn.determinant() < 0.0)) continue;
    notes.push_back(fmt::format(
        "{}: map mirrors {}: right for a sensor whose axes are a left-handed set, and no rotation",
        flight.name(), fmt::join(vectors[vector], ", ")));
  }
}

/// A new name that nothing reads and that is a letter away from one that something does.
void note_slips(const Flight& flight, const std::vector<Change>& changes,
                std::vector<std::string>& notes) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  for (const Change& change : changes) {
    if (std::ranges::any_of(change.header, is_digit)) continue;
    std::string near;
    bool is_known = false;
    for (const files::KnownQuantity& quantity : files::known_quantities()) {
      for (const std::string& header : files::accepted_headers(quantity.name, quantity.kind)) {
        const std::size_t slips = base::count_slips(change.header, header);
        is_known = is_known || slips == 0 || files::recognise(change.header, quantity);
        if (slips == 1 && near.empty()) near = header;
      }
    }
    if (is_known || near.empty()) continue;
    notes.push_back(
        fmt::format("{}: map {}={} reads the column as a channel of that name and as no "
                    "quantity; did you mean {}?",
                    flight.name(), change.header, change.from.header, near));
  }
}

void rename_columns(Flight& flight, const LogChoice& choice, std::vector<std::string>& notes) {
  const std::vector<Change> changes = changes_of(flight, choice);
  check_free(flight, changes);
  note_mirrors(flight, changes, notes);
  note_slips(flight, changes, notes);
  const auto between = [](std::size_t i) { return fmt::format("mapped column {}", i); };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    flight.rename(changes[i].from.header, between(i));
  }
  for (std::size_t i = 0; i < changes.size(); ++i) {
    flight.rename(between(i), changes[i].header);
    if (changes[i].from.is_negated) turn_sign(flight, changes[i].header);
  }
}

}  // namespace

std::optional<MappedColumn> find_mapped(const Flight& flight, const std::string& logged) {
  if (const Flight::Column* column = flight.find(logged)) return MappedColumn{column->header};
  if (!logged.starts_with('-')) return std::nullopt;
  const Flight::Column* column = flight.find(logged.substr(1));
  if (column == nullptr) return std::nullopt;
  return MappedColumn{column->header, true};
}

void choose_columns(Flight& flight, const LogChoice& choice, std::vector<std::string>& notes) {
  if (flight.find(files::flight_number) != nullptr) return;  // joined, each under these names
  const auto ignored_as_logged = [&](const std::string& header) {
    return is_ignored(choice, header) && flight.find(header) != nullptr;
  };
  std::vector<std::string> dropped;
  std::ranges::copy_if(choice.ignore, std::back_inserter(dropped), ignored_as_logged);
  for (const std::string& header : dropped) flight.drop(header);
  rename_columns(flight, choice, notes);
  for (const std::string& header : choice.ignore) {
    if (std::ranges::find(dropped, header) != dropped.end()) continue;
    if (flight.find(header) == nullptr) {
      fail(flight, "ignore",
           fmt::format(" names {}, which is no column; {}", header, flight.list_columns()));
    }
    flight.drop(header);
  }
}

}  // namespace sepcal::logs
