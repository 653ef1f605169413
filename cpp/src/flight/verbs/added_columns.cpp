// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/added_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "flight/files/csv_cells.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/csv.hpp"

namespace sepcal::verbs {

void write_with_columns(const Flight& flight, const std::vector<CorrectedColumn>& columns,
                        OutputFile& target) {
  std::vector<std::string> headers;
  for (const CorrectedColumn& column : columns) headers.push_back(column.header);
  write_with_columns(
      flight, headers, flight.rows(), [&](std::size_t, std::size_t) { return columns; }, target);
}

void write_with_columns(const Flight& flight, const std::vector<std::string>& headers,
                        std::size_t piece, const ColumnsOfRows& columns_of, OutputFile& target) {
  for (const std::string& header : headers) {
    if (flight.find(header) == nullptr) continue;
    throw Error(
        fmt::format("{} has a column '{}' already; apply the calibration to the original log",
                    flight.name(), header));
  }
  CsvReader lines(flight.name());
  std::string line(lines.text());
  for (const std::string& header : headers) line += "," + header;
  target.write(line + "\n");
  std::vector<CorrectedColumn> columns;
  std::size_t first = 0;
  std::size_t last = 0;
  for (std::size_t row = 0; lines.next(); ++row) {
    if (row == last) {
      first = last;
      last = std::min(first + piece, flight.rows());
      columns = columns_of(first, last);
    }
    line = lines.text();
    for (const CorrectedColumn& column : columns) {
      line += ',';
      files::append_number(line, column.values.at(row - first));
    }
    line += '\n';
    target.write(line);
  }
}

}  // namespace sepcal::verbs
