// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/residuals.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "flight/files/csv_cells.hpp"
#include "flight/files/headers.hpp"
#include "flight/probes/quantities.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "sepcal/detail/flight/read_as.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// "m/s^2" as a header ends: "mps2".
std::string suffix_of(const std::string& unit) {
  if (unit == "1") return "";
  std::string suffix = "_";
  for (const char c : unit) {
    if (c == '/') suffix += 'p';
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      suffix += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return suffix;
}

/// Where each row of the flight is among those that were compared; the number of these where it is
/// not. Empty where their times don't tell.
std::vector<std::size_t> places_of(const std::vector<double>& compared,
                                   const std::vector<double>& logged) {
  std::vector<std::size_t> places(logged.size(), compared.size());
  std::size_t next = 0;
  for (std::size_t row = 0; row < logged.size() && next < compared.size(); ++row) {
    if (logged[row] == compared[next]) places[row] = next++;
  }
  if (next < compared.size()) places.clear();
  return places;
}

double noise_of(const std::vector<OutputValue>& noise, const std::string& output) {
  const auto found = std::ranges::find(noise, output, &OutputValue::name);
  return found == noise.end() ? nothing : found->value;
}

using WhyNot = std::function<std::string_view(std::size_t row)>;

ResidualTable tabulate(const Comparison& comparison, const std::vector<double>& logged,
                       const std::vector<OutputValue>& noise, const WhyNot& why_not) {
  const std::size_t used = comparison.time.size();
  std::vector<std::size_t> places = places_of(comparison.time, logged);
  ResidualTable table;
  table.notes = comparison.notes;
  if (!logged.empty()) table.time = places.empty() ? comparison.time : logged;
  if (places.empty()) {
    for (std::size_t row = 0; row < used; ++row) places.push_back(row);
  }
  table.why_not.resize(places.size());
  for (std::size_t row = 0; row < places.size(); ++row) {
    if (places[row] == used) table.why_not[row] = why_not(row);
  }
  for (std::size_t j = 0; j < comparison.overall.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    ResidualTable::Output output{.name = comparison.overall[j].output,
                                 .unit = comparison.overall[j].unit};
    const double deviation = noise_of(noise, output.name);
    for (const std::size_t place : places) {
      const auto at = static_cast<Eigen::Index>(place);
      const double residual = place == used ? nothing : comparison.residuals(at, column);
      const double modelled = place == used ? nothing : comparison.modelled(at, column);
      output.measured.push_back(modelled + residual);
      output.modelled.push_back(modelled);
      output.residual.push_back(residual);
      output.whitened.push_back(residual / deviation);
    }
    table.outputs.push_back(std::move(output));
  }
  return table;
}

/// Where a choice's conditions don't say it.
std::string_view left_out(const LogChoice& choice) {
  return choice.drop_repeats.empty() ? "at an edge of what is used or no reading"
                                     : "between samples of a slow column, at an edge or no reading";
}

std::vector<double> time_of(const Flight& flight) {
  return files::read_quantity(flight, "time", files::UnitKind::time);
}

}  // namespace

std::size_t ResidualTable::rows_used() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(why_not, [](const std::string& why) { return why.empty(); }));
}

ResidualTable tabulate_residuals(const Calibration& calibration, const Flight& flight) {
  const Comparison comparison = compare(calibration, flight);
  std::vector<std::string> told_by_compare;
  const LogChoice choice = choice_for(calibration, flight, told_by_compare);
  const Flight read = read_as(flight, choice).flight;
  const logs::RowTruth is_taken = probes::rows_taken(*calibration.probe, read, choice);
  return tabulate(comparison, time_of(read), calibration.fit.noise,
                  [&](std::size_t row) -> std::string_view {
                    return is_taken && !is_taken(row) ? "not among the rows that were chosen"
                                                      : left_out(choice);
                  });
}

ResidualTable tabulate_residuals(const Comparison& comparison, const Flight& flight,
                                 const LogChoice& log, const std::vector<OutputValue>& noise) {
  const Flight read = read_as(flight, log).flight;
  return tabulate(comparison, time_of(read), noise, [&](std::size_t) { return left_out(log); });
}

std::vector<std::string> headers_of(const ResidualTable& table) {
  std::vector<std::string> headers;
  if (!table.time.empty()) headers.emplace_back("time_s");
  for (const ResidualTable::Output& output : table.outputs) {
    const std::string unit = suffix_of(output.unit);
    for (const char* const what : {"measured", "modelled", "residual"}) {
      headers.push_back(fmt::format("{}_{}{}", output.name, what, unit));
    }
    headers.push_back(output.name + "_whitened");
  }
  headers.emplace_back("used");
  headers.emplace_back("why_not");
  return headers;
}

void write_csv(const ResidualTable& table, OutputFile& target) {
  target.write(fmt::format("{}\n", fmt::join(headers_of(table), ",")));
  const auto append = [](std::string& line, double value) {
    if (!std::isnan(value)) files::append_number(line, value);
    line += ',';
  };
  for (std::size_t row = 0; row < table.rows(); ++row) {
    std::string line;
    if (!table.time.empty()) append(line, table.time[row]);
    for (const ResidualTable::Output& output : table.outputs) {
      for (const auto* column :
           {&output.measured, &output.modelled, &output.residual, &output.whitened}) {
        append(line, (*column)[row]);
      }
    }
    line += table.why_not[row].empty() ? "1," : "0," + table.why_not[row];
    target.write(line + "\n");
  }
}

}  // namespace sepcal
