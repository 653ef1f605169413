// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/apply.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "base/excerpt.hpp"
#include "flight/probes/joined_quantities.hpp"
#include "flight/verbs/added_columns.hpp"
#include "flight/verbs/driver_ranges.hpp"
#include "flight/verbs/effect_readings.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "sepcal/detail/flight/output_file.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

namespace {

/// As far as it can be read: what a fit left out for its own sake is calibrated all the same.
LogChoice every_row(const Calibration& calibration, const Flight& flight) {
  std::vector<std::string> unused;
  const LogChoice chosen = choice_for(calibration, flight, unused);
  return {.map = chosen.map,
          .ignore = chosen.ignore,
          .drop_invalid = chosen.drop_invalid,
          .join = chosen.join};
}

/// Where the calibration was fitted to some rows by what they hold or when they were: the column
/// that says, with a 1, which rows are not such. `flight` as read_as() gives it.
std::optional<CorrectedColumn> find_outside(const Calibration& calibration, const Flight& flight,
                                            std::vector<std::string>& notes) {
  LogChoice choice = choice_for(calibration, flight, notes);
  choice.join.clear();  // a row without a reading is not outside of anything
  const logs::RowTruth is_taken = probes::rows_taken(*calibration.probe, flight, choice);
  if (!is_taken) return std::nullopt;
  CorrectedColumn outside{"outside_fit", std::vector<double>(flight.rows(), 0.0)};
  for (std::size_t row = 0; row < flight.rows(); ++row) {
    outside.values[row] = is_taken(row) ? 0.0 : 1.0;
  }
  return outside;
}

/// Throws Error where a reading that can be corrected is not, as a parameter is not known of this
/// flight.
void check_corrected(const Calibration& calibration, const ProbeReadings& readings,
                     const std::vector<CorrectedColumn>& columns, const Flight& flight) {
  const auto unknown = std::ranges::find_if(
      calibration.fit.parameters, [](const Parameter& one) { return std::isnan(one.value); });
  if (unknown == calibration.fit.parameters.end()) return;
  for (const CorrectedColumn& column : columns) {
    for (std::size_t row = 0; row < column.values.size(); ++row) {
      if (!readings.valid[row] || !std::isnan(column.values[row])) continue;
      throw Error(fmt::format(
          "{}: {} is each flight's own, and this one was not fitted; fit it with the others",
          flight.name(), unknown->name));
    }
  }
}

std::vector<double> part_of(const std::vector<double>& values, std::size_t first,
                            std::size_t last) {
  return {values.begin() + static_cast<std::ptrdiff_t>(first),
          values.begin() + static_cast<std::ptrdiff_t>(last)};
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

bool has_state(const Calibration& calibration) {
  return !calibration.probe->initial_states().empty();
}

}  // namespace

std::vector<CorrectedColumn> apply(const Calibration& calibration, const Flight& flight) {
  if (has_state(calibration)) {
    ProbeReadings readings;
    return predict_along(calibration, flight, readings);
  }
  const LogChoice choice = every_row(calibration, flight);
  ReadFlight read = probes::read_for(*calibration.probe, flight, choice);
  ProbeReadings readings = calibration.probe->read(read.flight, choice);
  auto columns = correct_with_effects(calibration, read.flight, readings);
  check_corrected(calibration, readings, columns, flight);
  if (auto outside = find_outside(calibration, read.flight, read.notes)) {
    columns.push_back(std::move(*outside));
  }
  return columns;
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
  if (stream && probe.predicts()) {
    throw OptionError({Option{"stream"},
                       ": a model of your own is applied to whole columns; leave "
                       "it out"});
  }
  OutputFile target(output);
  const CsvForm form = calibration.options.log.form();
  const Flight flight =
      stream ? stream_csv(file, {}, progress, 0, form) : read_csv(file, progress, 0, form);
  Applied applied{
      .output = output, .rows = flight.rows(), .headers = probe.corrected_headers(), .notes = {}};
  const auto finish = [&](ProbeReadings& readings) {
    std::ranges::move(readings.notes, std::back_inserter(applied.notes));
    applied.rows_left_empty = static_cast<std::size_t>(std::ranges::count(readings.valid, false));
    target.commit();
    return applied;
  };
  if (has_state(calibration)) {
    ProbeReadings readings;
    write_with_columns(flight, predict_along(calibration, flight, readings), target);
    return finish(readings);
  }
  const LogChoice choice = every_row(calibration, flight);
  const ReadFlight read = probes::read_for(probe, flight, choice);
  applied.notes = read.notes;
  ProbeReadings readings = probe.read(read.flight, choice);
  auto columns = stream ? std::vector<CorrectedColumn>()
                        : correct_with_effects(calibration, read.flight, readings);
  check_corrected(calibration, readings, columns, flight);
  std::vector<std::string> more;
  const auto outside = find_outside(calibration, read.flight, more);
  std::ranges::move(more, std::back_inserter(readings.notes));
  note_beyond(calibration.driver_ranges, readings.record, readings.notes);
  if (outside) {
    applied.headers.push_back(outside->header);
    if (!stream) columns.push_back(*outside);
  }
  if (stream) {
    const auto columns_of = [&](std::size_t first, std::size_t last) {
      auto part = correct_rows(calibration, read.flight, readings, first, last);
      if (outside) part.push_back({outside->header, part_of(outside->values, first, last)});
      return part;
    };
    write_with_columns(flight, applied.headers, base::piece_rows, columns_of, target);
  } else {
    write_with_columns(flight, columns, target);
  }
  return finish(readings);
}

}  // namespace sepcal
