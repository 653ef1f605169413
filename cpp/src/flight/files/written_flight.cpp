// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/written_flight.hpp"

#include <string>

#include "base/stop.hpp"
#include "flight/files/csv_cells.hpp"

namespace sepcal::files {
void write_flight(const Flight& flight, OutputFile& target) {
  const auto labels = flight.maneuvers();
  std::string line;
  for (const Flight::Column& column : flight.columns()) {
    append_text(line, column.header);
    line += ',';
  }
  if (!labels.empty()) line += "maneuver,";
  for (std::size_t row = 0; row < flight.rows(); ++row) {
    base::heed_stop();
    line.back() = '\n';
    target.write(line);
    line.clear();
    for (const Flight::Column& column : flight.columns()) {
      append_number(line, column.values[row]);
      line += ',';
    }
    if (!labels.empty()) {
      append_text(line, labels[row]);
      line += ',';
    }
  }
  line.back() = '\n';
  target.write(line);
}

}  // namespace sepcal::files
