// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/added_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "flight/files/csv_cells.hpp"
#include "flight/files/written_flight.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/csv.hpp"

namespace sepcal::verbs {
namespace {

/// The header and the rows as plain comma-separated text: of the file where the flight is of a text
/// table, of its numbers and labels otherwise.
class FlightLines {
 public:
  explicit FlightLines(const Flight& flight) : flight_(flight) {
    if (flight.form()) file_.emplace(flight.name(), Progress(), *flight.form());
    text_ = files::written_header(flight);
  }

  std::string_view text() { return file_ ? file_->text() : std::string_view(text_); }

  bool next() {
    if (file_) return file_->next();
    if (row_ == flight_.rows()) return false;
    files::write_row(text_, flight_, row_++);
    return true;
  }

 private:
  const Flight& flight_;
  std::optional<CsvReader> file_;
  std::string text_;
  std::size_t row_ = 0;
};

}  // namespace

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
  FlightLines lines(flight);
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
