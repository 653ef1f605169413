// SPDX-License-Identifier: BSD-3-Clause
#include "flight/checks/taken_rows.hpp"

#include "flight/files/headers.hpp"
#include "flight/probes/quantities.hpp"
#include "sepcal/detail/quantity.hpp"

namespace sepcal::checks {

TakenRows take_rows(const probes::ModelQuantities& model, const Flight& flight,
                    const LogChoice& choice) {
  const logs::RowTruth is_taken = probes::rows_taken(model, flight, choice);
  TakenRows taken{flight};
  if (!is_taken) return taken;
  for (std::size_t row = 0; row < flight.rows(); ++row) {
    if (!is_taken(row)) taken.left_out.push_back(row);
  }
  const auto time = files::find_quantity(flight, "time", files::UnitKind::time);
  for (const Flight::Column& column : flight.columns()) {
    if (time && time->column->header == column.header) continue;
    std::vector<double> values(column.values.begin(), column.values.end());
    for (const std::size_t row : taken.left_out) values[row] = not_a_number;
    taken.flight.replace(column.header, std::move(values));
  }
  return taken;
}

}  // namespace sepcal::checks
