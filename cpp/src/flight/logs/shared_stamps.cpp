// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logs/shared_stamps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "flight/files/headers.hpp"
#include "flight/files/invalid_cells.hpp"

namespace sepcal::logs {
namespace {

/// Rows [first, last) with one stamp.
struct Stamp {
  std::size_t first;
  std::size_t last;
  std::size_t rows() const { return last - first; }
};

/// The stamps in their order; nothing where one is no number or they don't rise.
std::optional<std::vector<Stamp>> find_stamps(std::span<const double> time) {
  std::vector<Stamp> stamps;
  for (std::size_t row = 0; row < time.size(); ++row) {
    if (!files::is_reading(time[row])) return std::nullopt;
    if (row > 0 && time[row] == time[row - 1]) {
      ++stamps.back().last;
      continue;
    }
    if (row > 0 && time[row] < time[row - 1]) return std::nullopt;
    stamps.push_back({row, row + 1});
  }
  return stamps;
}

/// The value in the middle.
template <class T>
T median(std::vector<T> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  return *middle;
}

bool repeats_row(const Flight& flight, std::size_t row) {
  return std::ranges::all_of(flight.columns(), [&](const Flight::Column& column) {
    const double now = column.values[row];
    const double before = column.values[row - 1];
    return now == before || (std::isnan(now) && std::isnan(before));
  });
}

/// Whether nearly all rows that share a stamp say something of their own.
bool are_readings(const Flight& flight, const std::vector<Stamp>& stamps) {
  std::size_t shared = 0;
  std::size_t repeated = 0;
  for (const Stamp& stamp : stamps) {
    for (std::size_t row = stamp.first + 1; row < stamp.last; ++row) {
      ++shared;
      repeated += repeats_row(flight, row) ? 1U : 0U;
    }
  }
  return 2 * repeated < shared;
}

}  // namespace

void spread_stamps(Flight& flight, std::vector<std::string>& notes) {
  if (flight.is_mapped()) return;
  const auto logged = files::find_quantity(flight, "time", files::UnitKind::time);
  if (!logged) return;
  const std::span<const double> time = logged->column->values;
  constexpr std::size_t fewest_stamps = 4;
  const auto stamps = find_stamps(time);
  if (!stamps || stamps->size() < fewest_stamps) return;
  std::vector<std::size_t> rows;
  std::vector<double> steps;
  for (std::size_t i = 0; i + 1 < stamps->size(); ++i) {
    rows.push_back((*stamps)[i].rows());
    steps.push_back(time[(*stamps)[i + 1].first] - time[(*stamps)[i].first]);
  }
  const std::size_t usual = median(rows);
  if (usual < 2 || !are_readings(flight, *stamps)) return;
  const double step = median(steps);
  std::vector<double> spread(time.begin(), time.end());
  for (const Stamp& stamp : *stamps) {
    const std::size_t places = std::max(usual, stamp.rows());
    // The first second may have begun before the log: its rows are its last ones.
    const std::size_t skipped = &stamp == &stamps->front() ? places - stamp.rows() : 0;
    // A whole stamp has rows of its own count; one that breaks off, at the end, as many places.
    const bool is_last = &stamp == &stamps->back();
    const std::size_t parts = is_last || skipped > 0 ? places : stamp.rows();
    for (std::size_t row = stamp.first; row < stamp.last; ++row) {
      const auto place = static_cast<double>(skipped + row - stamp.first);
      spread[row] += step * place / static_cast<double>(parts);
    }
  }
  const std::string header = logged->column->header;
  notes.push_back(
      fmt::format("{}: {} shows the same in {} rows each: they are spread evenly to the next "
                  "stamp, {:.3g} s on",
                  flight.name(), header, usual, logged->unit->convert(step)));
  flight.replace(header, std::move(spread));
}

}  // namespace sepcal::logs
