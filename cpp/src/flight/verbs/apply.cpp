// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/apply.hpp"

#include <algorithm>

#include "base/excerpt.hpp"
#include "flight/verbs/added_columns.hpp"
#include "flight/verbs/effect_readings.hpp"
#include "sepcal/flight/output_file.hpp"
#include "sepcal/option_error.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

namespace {

/// As far as it can be read: what a fit left out for its own sake is calibrated all the same.
RowChoice every_row(const Calibration& calibration) {
  return {.drop_invalid = calibration.options.rows.drop_invalid};
}

/// The corrected readings of some rows of a flight without effects: each row is corrected by
/// itself.
std::vector<CorrectedColumn> correct_rows(const Calibration& calibration, const Flight& flight,
                                          const ProbeReadings& readings, std::size_t first,
                                          std::size_t last) {
  ProbeReadings part;
  for (const std::string& name : readings.record.names()) {
    part.record.view(name, readings.record.column(name).subspan(first, last - first));
  }
  for (std::size_t row = first; row < last; ++row) part.valid.push_back(readings.valid[row]);
  auto columns = calibration.probe->correct(part, own_values(calibration), {});
  flight.release(first, last);
  return columns;
}

}  // namespace

std::vector<CorrectedColumn> apply(const Calibration& calibration, const Flight& flight) {
  ProbeReadings readings = calibration.probe->read(flight, every_row(calibration));
  return correct_with_effects(calibration, flight, readings);
}

Applied apply_to_file(const Calibration& calibration, const std::string& file,
                      const std::string& output, const Progress& progress, bool stream) {
  const Probe& probe = *calibration.probe;
  check_not_input(output, file);
  if (stream && !calibration.options.effects.empty()) {
    throw OptionError({Option{"stream"},
                       ": the calibration's effects look at whole columns, which a streamed log "
                       "never has in memory; leave it out"});
  }
  OutputFile target(output);
  const Flight flight = stream ? stream_csv(file, {}, progress) : read_csv(file, progress);
  ProbeReadings readings = probe.read(flight, every_row(calibration));
  const auto columns =
      stream ? std::vector<CorrectedColumn>() : correct_with_effects(calibration, flight, readings);

  Applied applied{.output = output,
                  .rows = flight.rows(),
                  .headers = probe.corrected_headers(),
                  .notes = readings.notes};
  if (stream) {
    const auto columns_of = [&](std::size_t first, std::size_t last) {
      return correct_rows(calibration, flight, readings, first, last);
    };
    write_with_columns(flight, applied.headers, base::piece_rows, columns_of, target);
  } else {
    write_with_columns(flight, columns, target);
  }
  applied.rows_left_empty = static_cast<std::size_t>(std::ranges::count(readings.valid, false));
  target.commit();
  return applied;
}

}  // namespace sepcal
