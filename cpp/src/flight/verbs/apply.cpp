// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/apply.hpp"

#include <algorithm>

#include "flight/verbs/added_columns.hpp"
#include "flight/verbs/effect_readings.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/output_file.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

namespace {

/// As far as it can be read: what a fit left out for its own sake is calibrated all the same.
RowChoice every_row(const Calibration& calibration) {
  return {.drop_invalid = calibration.options.rows.drop_invalid};
}

}  // namespace

std::vector<CorrectedColumn> apply(const Calibration& calibration, const Flight& flight) {
  ProbeReadings readings = calibration.probe->read(flight, every_row(calibration));
  return correct_with_effects(calibration, flight, readings);
}

Applied apply_to_file(const Calibration& calibration, const std::string& file,
                      const std::string& output, const Progress& progress) {
  const Probe& probe = *calibration.probe;
  check_not_input(output, file);
  OutputFile target(output);
  const Flight flight = read_csv(file, progress);
  ProbeReadings readings = probe.read(flight, every_row(calibration));
  const auto columns = correct_with_effects(calibration, flight, readings);

  Applied applied{.output = output,
                  .rows = flight.rows(),
                  .headers = probe.corrected_headers(),
                  .notes = readings.notes};
  write_with_columns(flight, columns, target);
  applied.rows_left_empty = static_cast<std::size_t>(std::ranges::count(readings.valid, false));
  target.commit();
  return applied;
}

}  // namespace sepcal
