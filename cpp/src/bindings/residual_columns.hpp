// SPDX-License-Identifier: BSD-3-Clause
// The rows that `residuals` writes, for Python: headers with their arrays, and why a row was not
// used.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "sepcal/flight/residuals.hpp"

namespace sepcal::bindings {

using ResidualColumns =
    std::pair<std::vector<std::pair<std::string, Array>>, std::vector<std::string>>;

/// Columns of numbers in the file's order.
inline ResidualColumns residual_columns(ResidualTable table) {
  const std::vector<std::string> headers = headers_of(table);
  std::vector<std::pair<std::string, Array>> columns;
  const auto add = [&](std::vector<double>& values) {
    columns.emplace_back(headers[columns.size()], adopt(std::move(values)));
  };
  if (!table.time.empty()) add(table.time);
  for (ResidualTable::Output& output : table.outputs) {
    for (auto* column : {&output.measured, &output.modelled, &output.residual, &output.whitened}) {
      add(*column);
    }
  }
  return {std::move(columns), std::move(table.why_not)};
}

}  // namespace sepcal::bindings
