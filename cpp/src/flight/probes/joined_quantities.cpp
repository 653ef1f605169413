// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/joined_quantities.hpp"

#include <algorithm>
#include <vector>

#include "flight/files/headers.hpp"
#include "flight/files/invalid_cells.hpp"
#include "flight/logs/joined_rates.hpp"
#include "sepcal/error.hpp"

namespace sepcal::probes {
namespace {

using files::LoggedQuantity;

std::vector<LoggedQuantity> find_measured(std::span<const ProbeQuantity> quantities,
                                          const Flight& flight) {
  std::vector<LoggedQuantity> measured;
  for (const ProbeQuantity& quantity : quantities) {
    if (!quantity.is_measured) continue;
    const auto found = files::find_quantity(flight, quantity.name, quantity.kind, quantity.bare);
    if (found) measured.push_back(*found);
  }
  return measured;
}

std::vector<std::size_t> rows_of(const std::vector<LoggedQuantity>& measured, std::size_t count) {
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < count; ++row) {
    const auto is_there = [row](const LoggedQuantity& one) {
      return files::is_reading(one.at(row));
    };
    if (std::ranges::all_of(measured, is_there)) rows.push_back(row);
  }
  return rows;
}

}  // namespace

ReadFlight read_for(const ModelQuantities& model, const Flight& flight, const LogChoice& choice) {
  ReadFlight read = read_as(flight, choice);
  if (choice.join.empty()) return read;
  const logs::Joining joining = logs::parse_joining(choice.join);
  if (std::ranges::none_of(model.list, &ProbeQuantity::is_measured)) {
    throw OptionError({Option{"join"},
                       " brings quantities to the rows of a sensor's readings, and this model has "
                       "no such; leave it out"});
  }
  std::vector<LoggedQuantity> measured = find_measured(model.list, read.flight);
  if (measured.empty()) return read;  // who needs them says so
  std::vector<std::size_t> rows = rows_of(measured, flight.rows());
  if (rows.empty()) {
    measured.resize(1);
    rows = rows_of(measured, flight.rows());
  }
  logs::MeasuredRows to{std::move(rows), {}};
  for (const LoggedQuantity& one : measured) to.headers.push_back(one.column->header);
  logs::join_rates(read.flight, to, joining, read.notes);
  return read;
}

logs::RowTruth rows_measured(std::span<const ProbeQuantity> quantities, const Flight& flight,
                             const LogChoice& choice) {
  if (choice.join.empty()) return {};
  return [measured = find_measured(quantities, flight)](std::size_t row) {
    return std::ranges::all_of(
        measured, [row](const LoggedQuantity& one) { return files::is_reading(one.at(row)); });
  };
}

}  // namespace sepcal::probes
