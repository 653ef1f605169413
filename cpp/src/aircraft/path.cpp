// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/aircraft/path.hpp"

#include <algorithm>

#include "aircraft/held.hpp"
#include "base/name_list.hpp"
#include "sepcal/aircraft/output_error.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

TrajectoryOptions complete(TrajectoryOptions path, const Record& record) {
  if (path.outputs.empty()) {
    for (const Quantity& output : FlightPath::outputs) {
      if (record.has(output.name)) path.outputs.emplace_back(output.name);
    }
  }
  if (path.outputs.empty()) {
    throw Error("the record has none of a flight path's outputs, as airspeed or pitch; add them");
  }
  const bool heading = base::is_among(path.outputs, "yaw") || base::is_among(path.outputs, "vn");
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

}  // namespace

PathTrajectory lay_path(const Record& record, const PathOptions& options) {
  PathTrajectory laid{{}, with_states(record), options.fit, {}};
  laid.model = std::make_shared<const TrajectoryModel<FlightPath>>(
      FlightPath{.gravity = options.gravity, .vane = options.vane}, laid.record,
      complete(options.trajectory, laid.record));
  for (const auto& [name, value] : laid.model->initial_states(laid.record)) {
    laid.initial_states.push_back(name);
    laid.fit.start.emplace(name, value);
  }
  aircraft::hold_at_zero(held_of_path(laid.model->tables().linear), options.free, laid.fit);
  return laid;
}

}  // namespace sepcal
