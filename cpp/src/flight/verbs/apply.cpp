// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/apply.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>

#include "flight/verbs/effect_readings.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/output_file.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

namespace {

/// The shortest text that reads back as the same double; nothing for NaN.
void append_number(std::string& line, double value) {
  if (std::isnan(value)) return;
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  line.append(text.data(), end);
}

}  // namespace

std::vector<CorrectedColumn> apply(const Calibration& calibration, const Flight& flight) {
  ProbeReadings readings = calibration.probe->read(flight, calibration.options.drop_invalid);
  return correct_with_effects(calibration, flight, readings);
}

Applied apply_to_file(const Calibration& calibration, const std::string& file,
                      const std::string& output, const Progress& progress) {
  const Probe& probe = *calibration.probe;
  check_not_input(output, file);
  OutputFile target(output);
  const Flight flight = read_csv(file, progress);
  ProbeReadings readings = probe.read(flight, calibration.options.drop_invalid);
  const auto columns = correct_with_effects(calibration, flight, readings);

  Applied applied{.output = output,
                  .rows = flight.rows(),
                  .headers = probe.corrected_headers(),
                  .notes = readings.notes};
  for (const std::string& header : applied.headers) {
    if (flight.find(header) == nullptr) continue;
    throw Error(fmt::format(
        "{} has a column '{}' already; apply the calibration to the original log", file, header));
  }
  CsvReader lines(file);
  std::string line(lines.text());
  for (const std::string& header : applied.headers) line += "," + header;
  target.write(line + "\n");
  for (std::size_t row = 0; lines.next(); ++row) {
    line = lines.text();
    for (const CorrectedColumn& column : columns) {
      line += ',';
      append_number(line, column.values.at(row));
    }
    line += '\n';
    target.write(line);
    if (!readings.valid[row]) ++applied.rows_left_empty;
  }
  target.commit();
  return applied;
}

}  // namespace sepcal
