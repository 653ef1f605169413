// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ranges>

#include "option_spelling.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/output_file.hpp"

namespace sepcal {
namespace {

/// A fit with more parameters than rows is refused, even where three outputs a row would make it
/// solvable: it would calibrate a flight of a few samples.
void check_rows(const Probe& probe, const CalibrationOptions& options, const Flight& flight,
                std::size_t rows) {
  const std::size_t parameters =
      probe.model().tables().parameters().size() - options.fit.fixed.size();
  if (rows >= parameters) return;
  throw Error(
      fmt::format("{}: {} usable rows are fewer than the {} parameters; log more, or {} some",
                  flight.name(), rows, parameters, spell_option("fix")));
}

void check_freed(const Probe& probe, const CalibrationOptions& options) {
  const std::vector<Variable> parameters = probe.model().tables().parameters();
  for (const std::string& name : options.free) {
    if (std::ranges::find(parameters, name, &Variable::name) == parameters.end()) {
      throw Error(
          fmt::format("{} {}: there is no such parameter; the model has: {}", spell_option("free"),
                      name, fmt::join(parameters | std::views::transform(&Variable::name), ", ")));
    }
    if (options.fit.fixed.contains(name)) {
      throw Error(fmt::format("{1} {0} and {2} {0} contradict each other; keep one", name,
                              spell_option("free"), spell_option("fix")));
    }
  }
}

/// Rows that a stage's segments select; messages say of which flight and option.
std::size_t count_rows(const Record& record, const std::string& segments, const Flight& flight,
                       std::string_view stage, std::string_view option) {
  try {
    return record.select(segments).rows();
  } catch (const Error& error) {
    throw Error(fmt::format("{}: the segments of {} ({}): {}", flight.name(), stage,
                            spell_option(option), error.what()));
  }
}

}  // namespace

Calibration calibrate(std::shared_ptr<const Probe> probe, const Flight& flight,
                      const CalibrationOptions& options) {
  check_freed(*probe, options);
  const ProbeRecord prepared = probe->prepare(flight, options.drop_invalid);
  count_rows(prepared.record, options.fit.stage_one_segments, flight, "stage one", "stage_one");
  check_rows(*probe, options, flight,
             count_rows(prepared.record, options.fit.stage_two_segments, flight, "stage two",
                        "stage_two"));
  Calibration calibration;
  calibration.fit = fit(probe->model(), prepared.record, options.fit);
  calibration.probe = std::move(probe);
  calibration.options = options;
  calibration.flight = {flight.name(), flight.sha256(), flight.rows(), calibration.fit.rows};
  calibration.notes = prepared.notes;
  return calibration;
}

void write_calibration(const Calibration& calibration, const std::string& file) {
  OutputFile output(file);
  output.write(to_json(calibration));
  output.commit();
}

}  // namespace sepcal
