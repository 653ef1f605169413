// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/quantities.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flight/probes/joined_quantities.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal::probes {
ModelQuantities::ModelQuantities(const Probe& probe) : list(probe.quantities()) {}

logs::RowTruth rows_taken(const ModelQuantities& model, const Flight& flight,
                          const LogChoice& choice) {
  const std::span<const ProbeQuantity> quantities = model.list;
  const auto find = [&](const std::string& name) -> std::optional<files::LoggedQuantity> {
    const auto quantity = std::ranges::find(quantities, name, &ProbeQuantity::name);
    if (quantity == quantities.end()) return std::nullopt;
    return files::find_quantity(flight, quantity->name, quantity->kind, quantity->bare);
  };
  const logs::RowTruth within = logs::rows_within_times(flight, choice);
  const logs::RowTruth holds = logs::rows_where(flight, choice, find);
  std::vector<logs::RowTruth> tests;
  for (logs::RowTruth test : {rows_measured(quantities, flight, choice), within, holds}) {
    if (test) tests.push_back(std::move(test));
  }
  if (tests.size() < 2) return tests.empty() ? logs::RowTruth() : tests.front();
  return [tests](std::size_t row) {
    return std::ranges::all_of(tests, [row](const logs::RowTruth& test) { return test(row); });
  };
}

}  // namespace sepcal::probes
