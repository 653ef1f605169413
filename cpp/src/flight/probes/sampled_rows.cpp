// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/sampled_rows.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "flight/probes/sequence.hpp"
#include "sepcal/error.hpp"

namespace sepcal::probes {
namespace {

constexpr double about_as_slow = 1.1;  // samples over the slowest column's

/// The whole header first; else the only one that is this name and a unit.
const Flight::Column& find_column(const Flight& flight, const std::string& name) {
  if (const Flight::Column* column = flight.find(name)) return *column;
  const auto is_named = [&](const Flight::Column& column) {
    return is_called(column.header, name);
  };
  const auto found = std::ranges::find_if(flight.columns(), is_named);
  if (found != flight.columns().end()) return *found;
  throw OptionError(
      {flight.name() + ": ", Option{"drop_repeats"},
       fmt::format(" names {}, which is no column; {}", name, flight.list_columns())});
}

}  // namespace

bool is_called(const std::string& header, const std::string& name) {
  return name == header || name == header.substr(0, header.rfind('_'));
}

std::vector<bool> find_sampled(const Flight& flight, const std::vector<std::string>& columns,
                               const std::vector<double>& time) {
  std::vector<Segment> stretches{{"", 0, flight.rows()}};
  if (!time.empty()) stretches = find_stretches(time, flight.maneuvers());
  std::vector<std::vector<std::size_t>> samples;
  std::size_t fewest = flight.rows();
  for (const std::string& name : columns) {
    samples.push_back(find_sampled_rows(find_column(flight, name).values, stretches));
    fewest = std::min(fewest, samples.back().size());
  }
  std::vector<bool> sampled(flight.rows(), false);
  for (const std::vector<std::size_t>& own : samples) {
    if (static_cast<double>(own.size()) > about_as_slow * static_cast<double>(fewest)) continue;
    for (const std::size_t row : own) sampled[row] = true;
  }
  return sampled;
}

}  // namespace sepcal::probes
