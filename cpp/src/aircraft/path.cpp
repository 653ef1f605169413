// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/aircraft/path.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "aircraft/held.hpp"
#include "base/name_list.hpp"
#include "sepcal/aircraft/output_error.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

template <class Path>
TrajectoryOptions complete(TrajectoryOptions path, const Record& record) {
  if (path.outputs.empty()) {
    for (const Quantity& output : Path::outputs) {
      if (record.has(output.name)) path.outputs.emplace_back(output.name);
    }
  }
  if (path.outputs.empty()) {
    throw Error("the record has none of a flight path's outputs, as airspeed or pitch; add them");
  }
  const bool heading = base::is_among(path.outputs, "yaw") || base::is_among(path.outputs, "vn") ||
                       base::is_among(path.outputs, "north");
  if (!heading && !base::is_among(path.measured, "psi")) path.measured.emplace_back("psi");
  return path;
}

std::vector<std::string> held_of_path(const std::vector<Variable>& linear) {
  std::vector<std::string> held;
  for (const Variable& parameter : linear) {
    const auto& all = FlightPath::held_at_zero;
    if (std::ranges::find(all, parameter.name) != all.end()) held.push_back(parameter.name);
  }
  return held;
}

/// The standard deviation of white noise on a column that is smooth without; 0 of none.
double white_noise_of(std::span<const double> values, const std::vector<Segment>& segments) {
  constexpr double gain = 70.0;  // 1 + 16 + 36 + 16 + 1, of a fourth difference's variance
  double squares = 0.0;
  std::size_t count = 0;
  for (const Segment& segment : segments) {
    for (std::size_t i = segment.first; i + 4 < segment.last; ++i) {
      const double difference = values[i] - 4.0 * values[i + 1] + 6.0 * values[i + 2] -
                                4.0 * values[i + 3] + values[i + 4];
      if (!std::isfinite(difference)) continue;
      squares += difference * difference;
      ++count;
    }
  }
  return count == 0 ? 0.0 : std::sqrt(squares / (gain * static_cast<double>(count)));
}

/// The mean time from row to row, s.
double mean_step(const Record& record) {
  const std::span<const double> time = record.column("time");
  double span = 0.0;
  std::size_t steps = 0;
  for (const Segment& segment : record.segments()) {
    span += time[segment.last - 1] - time[segment.first];
    steps += segment.rows() - 1;
  }
  return steps == 0 ? 0.0 : span / static_cast<double>(steps);
}

}  // namespace

std::map<std::string, double> white_noise_of(const Record& record,
                                             const std::vector<std::string>& columns) {
  std::map<std::string, double> deviations;
  for (const std::string& name : columns) {
    deviations[name] = white_noise_of(record.column(name), record.segments());
  }
  return deviations;
}

std::map<std::string, double> noise_of_readings(const Record& record) {
  constexpr double rounding = 1e-12;  // of the largest reading
  const double dt = mean_step(record);
  std::map<std::string, double> densities;
  for (const Quantity& reading : FlightPath::noise) {
    const std::string name(reading.name);
    const std::span<const double> values = record.column(name);
    const double noise = white_noise_of(values, record.segments());
    double largest = 0.0;
    for (const double value : values) largest = std::max(largest, std::abs(value));
    if (noise > rounding * largest) densities[name] = noise * std::sqrt(dt);
  }
  return densities;
}

PathTrajectory lay_path(const Record& record, const PathOptions& options) {
  PathTrajectory laid{{}, with_states(record), options.fit, {}};
  const auto lay = [&]<class Path>(const Path& path) {
    const auto model = std::make_shared<const TrajectoryModel<Path>>(
        path, laid.record, complete<Path>(options.trajectory, laid.record));
    for (const auto& [name, value] : model->initial_states(laid.record)) {
      laid.initial_states.push_back(name);
      laid.fit.start.emplace(name, value);
    }
    laid.model = model;
  };
  if (options.position) {
    lay(FlightPathWithPosition{.gravity = options.gravity, .vane = options.vane});
  } else {
    lay(FlightPath{.gravity = options.gravity, .vane = options.vane});
  }
  aircraft::hold_at_zero(held_of_path(laid.model->tables().linear), options.free, laid.fit);
  return laid;
}

}  // namespace sepcal
