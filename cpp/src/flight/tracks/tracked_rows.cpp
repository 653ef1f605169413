// SPDX-License-Identifier: BSD-3-Clause
#include "flight/tracks/tracked_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace sepcal::tracks {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// The correlation of neighbours among numbers, of which some may be NaN; 0 of too few.
double lag_one(const VectorXd& e) {
  constexpr Index fewest = 100;
  double product = 0.0;
  double square = 0.0;
  Index pairs = 0;
  for (Index i = 1; i < e.size(); ++i) {
    if (std::isnan(e[i]) || std::isnan(e[i - 1])) continue;
    product += e[i] * e[i - 1];
    square += 0.5 * (e[i] * e[i] + e[i - 1] * e[i - 1]);
    ++pairs;
  }
  return pairs < fewest || square == 0.0 ? 0.0 : product / square;
}

/// The flight's rows of the track and of its changes.
void set_rows(TrackedFlight& tracked, const std::vector<std::size_t>& flight_rows) {
  for (const std::size_t row : tracked.track.rows) {
    tracked.flight_rows.push_back(flight_rows[row]);
  }
  for (Change& change : tracked.track.changes) {
    change.onset = flight_rows[change.onset];
    change.found = flight_rows[change.found];
  }
}

/// Adds a note where neighbouring innovations of an output correlate, as in gusts: the filter then
/// takes each row for news, and its standard deviations are too small.
void note_colour(TrackedFlight& tracked) {
  constexpr double white = 0.2;
  for (std::size_t j = 0; j < tracked.outputs.size(); ++j) {
    const double r = lag_one(tracked.track.innovations.col(static_cast<Index>(j)));
    if (r < white) continue;
    // Of an exponential correlation the mean of n rows is as good as that of n (1 - r) / (1 + r).
    tracked.notes.push_back(fmt::format(
        "innovations of {} correlate from row to row ({:.2f}; white noise 0), as in gusts: "
        "standard deviations are too small, by a factor of up to {:.2g}; let what moves walk "
        "(--walk NAME=SD), or take every n-th row",
        tracked.outputs[j].name, r, std::sqrt((1.0 + r) / std::max(1e-3, 1.0 - r))));
  }
}

/// Adds a note where a parameter jumped three times or more, always the same way: it drifts.
void note_drift(TrackedFlight& tracked) {
  constexpr std::size_t fewest = 3;
  struct Jumps {
    std::vector<double> sizes;
    double first = 0.0;  // s, of the first onset
    double last = 0.0;   // s, where the last was found
  };
  std::map<std::string, Jumps> all;
  for (const Change& change : tracked.track.changes) {
    for (const ParameterChange& moved : change.parameters) {
      Jumps& jumps = all[moved.name];
      if (jumps.sizes.empty()) jumps.first = change.onset_time;
      jumps.sizes.push_back(moved.after - moved.before);
      jumps.last = change.found_time;
    }
  }
  for (const auto& [name, jumps] : all) {
    const auto up = static_cast<std::size_t>(
        std::ranges::count_if(jumps.sizes, [](double size) { return size > 0.0; }));
    const double seconds = jumps.last - jumps.first;
    if (jumps.sizes.size() < fewest || (up != 0 && up != jumps.sizes.size())) continue;
    if (!(seconds > 0.0)) continue;  // a record without time, too
    double squares = 0.0;
    for (const double size : jumps.sizes) squares += size * size;
    tracked.notes.push_back(fmt::format(
        "{} jumped {} times, always {}: it drifts; let it walk, --walk {}={:.2g}", name,
        jumps.sizes.size(), up > 0 ? "up" : "down", name, std::sqrt(squares / seconds)));
  }
}

}  // namespace

void place_in_flight(TrackedFlight& tracked, const std::vector<std::size_t>& flight_rows) {
  set_rows(tracked, flight_rows);
  note_colour(tracked);
  note_drift(tracked);
}

}  // namespace sepcal::tracks
