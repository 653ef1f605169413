// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/added_columns.hpp"

#include <fmt/format.h>

#include <string>

#include "flight/files/csv_cells.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/csv.hpp"

namespace sepcal::verbs {
void write_with_columns(const Flight& flight, const std::vector<CorrectedColumn>& columns,
                        OutputFile& target) {
  for (const CorrectedColumn& column : columns) {
    if (flight.find(column.header) == nullptr) continue;
    throw Error(
        fmt::format("{} has a column '{}' already; apply the calibration to the original log",
                    flight.name(), column.header));
  }
  CsvReader lines(flight.name());
  std::string line(lines.text());
  for (const CorrectedColumn& column : columns) line += "," + column.header;
  target.write(line + "\n");
  for (std::size_t row = 0; lines.next(); ++row) {
    line = lines.text();
    for (const CorrectedColumn& column : columns) {
      line += ',';
      files::append_number(line, column.values.at(row));
    }
    line += '\n';
    target.write(line);
  }
}

}  // namespace sepcal::verbs
