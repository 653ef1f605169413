// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/written_flight.hpp"

#include <string>

#include "base/stop.hpp"
#include "flight/files/csv_cells.hpp"

namespace sepcal::files {

std::string written_header(const Flight& flight) {
  std::string line;
  for (const Flight::Column& column : flight.columns()) {
    if (!line.empty()) line += ',';
    append_text(line, column.header);
  }
  if (!flight.maneuvers().empty()) line += ",maneuver";
  return line;
}

void write_row(std::string& line, const Flight& flight, std::size_t row) {
  line.clear();
  for (const Flight::Column& column : flight.columns()) {
    if (&column != flight.columns().data()) line += ',';
    append_number(line, column.values[row]);
  }
  if (flight.maneuvers().empty()) return;
  line += ',';
  append_text(line, flight.maneuvers()[row]);
}

void write_flight(const Flight& flight, OutputFile& target) {
  target.write(written_header(flight) + "\n");
  std::string line;
  for (std::size_t row = 0; row < flight.rows(); ++row) {
    base::heed_stop();
    write_row(line, flight, row);
    target.write(line + "\n");
  }
}

}  // namespace sepcal::files
