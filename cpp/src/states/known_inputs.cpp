// SPDX-License-Identifier: BSD-3-Clause
#include "states/known_inputs.hpp"

#include <cmath>
#include <span>
#include <string>

#include "sepcal/error.hpp"

namespace sepcal {

void states::check_inputs(const Tables& tables, const Record& record) {
  for (const Variable& input : tables.inputs) {
    if (!record.has(input.name) && std::isfinite(input.absent)) continue;
    const std::span<const double> column = record.column(input.name);
    for (const Segment& segment : record.segments()) {
      for (std::size_t row = segment.first; row < segment.last; ++row) {
        if (std::isfinite(column[row])) continue;
        throw Error("column '" + input.name + "' is not a finite number in row " +
                    std::to_string(row) + " (counted from 0); only outputs may be missing");
      }
    }
  }
}

}  // namespace sepcal
