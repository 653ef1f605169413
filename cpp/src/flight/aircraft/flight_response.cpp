// SPDX-License-Identifier: BSD-3-Clause
// Frequency responses of a log's columns.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/page.hpp"
#include "flight/aircraft/laid_aircraft.hpp"
#include "flight/files/csv_cells.hpp"
#include "flight/json/output_values.hpp"
#include "flight/probes/joined_quantities.hpp"
#include "flight/probes/record_builder.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/frequency.hpp"

namespace sepcal {

using base::Page;
using base::page;

namespace {

constexpr std::array time_alone{probes::ProbeQuantity{"time", files::UnitKind::time}};

/// The kept rows of a log's columns as they stand, where a cell may be no number.
Record columns_of(const Flight& flight, const ProbeRecord& prepared,
                  const std::vector<std::string>& headers) {
  Record record;
  const auto time = prepared.record.column("time");
  record.add("time", {time.begin(), time.end()});
  for (const std::string& header : headers) {
    const Flight::Column* column = flight.find(header);
    if (column == nullptr) {
      throw Error(fmt::format("{}: column '{}' is missing; {}", flight.name(), header,
                              flight.list_columns()));
    }
    if (record.has(header)) continue;  // that it is named twice is said of all logs alike
    std::vector<double> values;
    values.reserve(prepared.flight_rows.size());
    for (const std::size_t row : prepared.flight_rows) values.push_back(column->values[row]);
    record.add(header, std::move(values));
  }
  record.cut(prepared.record.segments());
  return record;
}

}  // namespace

FlightResponse find_response(const Flight& flight, const std::vector<std::string>& inputs,
                             const std::string& output, const ResponseOptions& options,
                             const LogChoice& log) {
  const probes::ModelQuantities quantities(time_alone, probes::LooksAt::coefficients);
  const ReadFlight read = probes::read_for(quantities, flight, log);
  probes::RecordBuilder builder(read.flight, quantities.list, log);
  builder.need({"time"});
  builder.keep_valid();
  builder.check_time();
  const ProbeRecord prepared = builder.finish();
  if (flight.is_mapped()) {
    throw Error(flight.name() + " is longer than memory; give a part of it");
  }
  std::vector<std::string> headers = inputs;
  headers.push_back(output);
  const Record record = columns_of(read.flight, prepared, headers);
  FlightResponse result{
      .found = aircraft_log::within(
          flight, [&] { return frequency_response(record, inputs, output, options); }),
      .file = flight.name(),
      .rows = flight.rows(),
      .notes = read.notes};
  for (const Dropped& dropped : prepared.dropped) {
    result.notes.push_back(fmt::format("{}: {} rows of {} were dropped: {}", flight.name(),
                                       dropped.rows, flight.rows(), dropped.reason));
  }
  return result;
}

void write_csv(const FlightResponse& response, OutputFile& target) {
  const FrequencyResponse& found = response.found;
  const MagnitudeAndPhase polar = magnitude_and_phase(found);
  std::string line = "frequency_hz";
  for (const std::string& input : found.inputs) {
    for (const char* what : {"magnitude", "magnitude_low", "magnitude_high", "phase_rad",
                             "phase_low_rad", "phase_high_rad", "coherence"}) {
      line += ',';
      files::append_text(line, input + "_" + what);
    }
  }
  target.write(line + "\n");
  for (std::size_t m = 0; m < found.frequencies.size(); ++m) {
    const auto row = static_cast<Eigen::Index>(m);
    line.clear();
    files::append_number(line, found.frequencies[m]);
    for (Eigen::Index i = 0; i < found.response.cols(); ++i) {
      for (const Eigen::MatrixXd* column :
           {&polar.magnitude, &polar.magnitude_low, &polar.magnitude_high, &polar.phase,
            &polar.phase_low, &polar.phase_high, &found.coherence}) {
        line += ',';
        files::append_number(line, (*column)(row, i));
      }
    }
    target.write(line + "\n");
  }
}

std::string to_text(const FlightResponse& response, Detail detail) {
  constexpr std::size_t few = 20;
  const FrequencyResponse& found = response.found;
  const MagnitudeAndPhase polar = magnitude_and_phase(found);
  Page text = page("{} to {}: {} rows of {}\n", base::joined(found.inputs, ", "), found.output,
                   response.rows, response.file);
  text += page("{} windows of {:.4g} s, worth {:.3g} independent ones\n", found.windows,
               found.window, found.averages);
  const std::size_t count = found.frequencies.size();
  const std::size_t every = detail == Detail::explained ? 1 : std::max<std::size_t>(1, count / few);
  for (Eigen::Index i = 0; i < found.response.cols(); ++i) {
    text += page("\n{}\n{:>9} {:>11} {:>10} {:>10} {:>6} {:>9}\n",
                 found.inputs[static_cast<std::size_t>(i)], "Hz", "magnitude", "+-", "phase deg",
                 "+-", "coherence");
    for (std::size_t m = 0; m < count; m += every) {
      const auto row = static_cast<Eigen::Index>(m);
      constexpr double degrees = 57.29577951308232;
      text +=
          page("{:>9.4g} {:>11.4g} {:>10.2g} {:>10.1f} {:>6.1f} {:>9.3f}\n", found.frequencies[m],
               polar.magnitude(row, i), found.radius(row, i), degrees * polar.phase(row, i),
               degrees * (polar.phase_high(row, i) - polar.phase(row, i)), found.coherence(row, i));
    }
  }
  return text.text();
}

std::string to_json(const FlightResponse& response) {
  using json::Json;
  const FrequencyResponse& found = response.found;
  const MagnitudeAndPhase polar = magnitude_and_phase(found);
  Json root = {{"schema_version", schema_version}, {"file", response.file},
               {"output", found.output},           {"window", found.window},
               {"windows", found.windows},         {"averages", found.averages},
               {"frequencies", found.frequencies}};
  root["inputs"] = Json::object();
  for (Eigen::Index i = 0; i < found.response.cols(); ++i) {
    const auto list = [&](const Eigen::MatrixXd& of) {
      Json values = Json::array();
      for (const double value : of.col(i)) values.push_back(json::number(value));
      return values;
    };
    root["inputs"][found.inputs[static_cast<std::size_t>(i)]] = {
        {"magnitude", list(polar.magnitude)},
        {"magnitude_low", list(polar.magnitude_low)},
        {"magnitude_high", list(polar.magnitude_high)},
        {"phase", list(polar.phase)},
        {"phase_low", list(polar.phase_low)},
        {"phase_high", list(polar.phase_high)},
        {"coherence", list(found.coherence)}};
  }
  return json::text_of(root);
}

}  // namespace sepcal
