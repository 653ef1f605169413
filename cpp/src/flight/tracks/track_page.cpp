// SPDX-License-Identifier: BSD-3-Clause
// What is written and said of a flight that was followed.
#include <algorithm>
#include <cmath>

#include "base/name_list.hpp"
#include "base/page.hpp"
#include "flight/files/csv_cells.hpp"
#include "flight/files/headers.hpp"
#include "flight/json/output_values.hpp"
#include "flight/text/pages.hpp"
#include "sepcal/flight/track.hpp"

namespace sepcal {

using base::page;
using base::Page;

void write_csv(const TrackedFlight& tracked, OutputFile& target) {
  const Track& track = tracked.track;
  const bool timed = !track.time.empty();
  std::string line = timed ? "time_s" : "";
  for (const Variable& estimate : tracked.table) {
    line += (line.empty() ? "" : ",") + files::header_of(estimate.name, estimate.unit) + "," +
            files::header_of(estimate.name + "_sd", estimate.unit);
  }
  for (const Variable& output : tracked.outputs) {
    line += "," + files::header_of(output.name + "_innovation", output.unit);
  }
  target.write(line + "\n");
  for (Eigen::Index row = 0; row < track.estimates.rows(); ++row) {
    line.clear();
    if (timed) files::append_number(line, track.time[static_cast<std::size_t>(row)]);
    const auto add = [&line](double value) {
      if (!line.empty()) line += ',';
      files::append_number(line, value);
    };
    for (Eigen::Index k = 0; k < track.estimates.cols(); ++k) {
      add(track.estimates(row, k));
      add(track.standard_deviations(row, k));
    }
    for (Eigen::Index j = 0; j < track.innovations.cols(); ++j) add(track.innovations(row, j));
    target.write(line + "\n");
  }
}

namespace {

json::Json changes_of(const TrackedFlight& tracked) {
  json::Json changes = json::Json::array();
  for (const Change& change : tracked.track.changes) {
    json::Json parameters = json::Json::object();
    for (const ParameterChange& moved : change.parameters) {
      parameters[moved.name] = {{"before", json::number(moved.before)},
                                {"after", json::number(moved.after)},
                                {"standard_deviation", json::number(moved.standard_deviation)},
                                {"rivals", moved.rivals}};
    }
    changes.push_back({{"onset_row", change.onset},
                       {"found_row", change.found},
                       {"onset_s", json::number(change.onset_time)},
                       {"found_s", json::number(change.found_time)},
                       {"statistic", json::number(change.statistic)},
                       {"parameters", parameters}});
  }
  return changes;
}

}  // namespace

std::string to_json(const TrackedFlight& tracked) {
  using json::Json;
  const Track& track = tracked.track;
  const Eigen::Index last = track.estimates.rows() - 1;
  Json estimates = Json::object();
  for (Eigen::Index k = 0; k < track.estimates.cols(); ++k) {
    const Variable& estimate = tracked.table[static_cast<std::size_t>(k)];
    estimates[estimate.name] = {
        {"value", json::number(track.estimates(last, k))},
        {"standard_deviation", json::number(track.standard_deviations(last, k))},
        {"unit", estimate.unit}};
  }
  return json::text_of({{"schema_version", schema_version},
                        {"flight", tracked.file},
                        {"rows", track.rows.size()},
                        {"refused", track.refused},
                        {"not_converged", track.not_converged},
                        {"changes", changes_of(tracked)},
                        {"last", estimates}});
}

namespace {

/// What jumped, when, from what to what.
Page changes_text(const TrackedFlight& tracked) {
  Page text;
  for (const Change& change : tracked.track.changes) {
    text += std::isnan(change.onset_time)
                ? page("\nfrom row {} on the parameters are others (said at row {}):\n",
                       change.onset, change.found)
                : page("\nfrom {:.6g} s on the parameters are others (said at {:.6g} s):\n",
                       change.onset_time, change.found_time);
    for (const ParameterChange& moved : change.parameters) {
      const auto variable = std::ranges::find(tracked.table, moved.name, &Variable::name);
      text +=
          page("  {:<14} {:>12.5g} -> {:>12.5g}  sd {:.3g}  {}{}\n", moved.name, moved.before,
               moved.after, moved.standard_deviation, variable->unit,
               moved.rivals.empty() ? "" : fmt::format("; or {}", base::list_names(moved.rivals)));
    }
  }
  return text;
}

}  // namespace

std::string to_text(const TrackedFlight& tracked, Detail /*detail*/) {
  const Track& track = tracked.track;
  const Eigen::Index last = track.estimates.rows() - 1;
  Page text = page("{} rows of {} tracked", track.rows.size(), tracked.file);
  text += track.time.empty() ? page("\n") : page(", to {:.6g} s\n", track.time.back());
  text += page("{:<14} {:>12} {:>12} {:>12} {:>12}  unit\n", "", "first", "sd", "last", "sd");
  for (Eigen::Index k = 0; k < track.estimates.cols(); ++k) {
    const Variable& estimate = tracked.table[static_cast<std::size_t>(k)];
    text += page("{:<14} {:>12.5g} {:>12.3g} {:>12.5g} {:>12.3g}  {}\n", estimate.name,
                 track.estimates(0, k), track.standard_deviations(0, k), track.estimates(last, k),
                 track.standard_deviations(last, k), estimate.unit);
  }
  text += changes_text(tracked);
  if (track.refused > 0) {
    text += page("{} rows were refused: something there is no finite number\n", track.refused);
  }
  if (track.not_converged > 0) {
    text += page("{} rows ended by the cap of the iterations\n", track.not_converged);
  }
  return text.text();
}

}  // namespace sepcal
