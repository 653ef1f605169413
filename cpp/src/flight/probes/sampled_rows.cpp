// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/sampled_rows.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "flight/probes/sequence.hpp"
#include "sepcal/option_error.hpp"

namespace sepcal::probes {
namespace {

/// The whole header first; else the only one that is this name and a unit.
const Flight::Column& find_column(const Flight& flight, const std::string& name) {
  if (const Flight::Column* column = flight.find(name)) return *column;
  const auto is_named = [&](const Flight::Column& column) {
    return column.header.substr(0, column.header.rfind('_')) == name;
  };
  const auto found = std::ranges::find_if(flight.columns(), is_named);
  if (found != flight.columns().end()) return *found;
  throw OptionError(
      {flight.name() + ": ", Option{"drop_repeats"},
       fmt::format(" names {}, which is no column; {}", name, flight.list_columns())});
}

}  // namespace

std::vector<bool> find_sampled(const Flight& flight, const std::vector<std::string>& columns,
                               const std::vector<double>& time) {
  std::vector<Segment> stretches{{"", 0, flight.rows()}};
  if (!time.empty()) stretches = find_stretches(time, flight.maneuvers());
  std::vector<bool> sampled(flight.rows(), false);
  for (const std::string& name : columns) {
    for (const std::size_t row : find_sampled_rows(find_column(flight, name).values, stretches)) {
      sampled[row] = true;
    }
  }
  return sampled;
}

}  // namespace sepcal::probes
