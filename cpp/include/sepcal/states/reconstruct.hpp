// SPDX-License-Identifier: BSD-3-Clause
// What was flown: the states of a flight path along its record.
#pragma once

#include <map>
#include <string>

#include "sepcal/detail/states/state_steps.hpp"
#include "sepcal/record.hpp"
#include "sepcal/states/track.hpp"

namespace sepcal {

/// What was flown, by a fit's parameters (Fit::by_name()): the record with its accelerations and
/// rates corrected, a + b; airspeed, alpha and beta as error-free sensors at the vane read them,
/// roll, pitch, yaw, and u v w phi theta psi, of a path with position x y z too, as integrated.
/// Columns that the record doesn't have are added. NaN outside segments. `path` is a
/// TrajectoryModel of FlightPath or FlightPathWithPosition; throws Error for another model.
Record reconstruct(const StateBlockModel& path, const std::map<std::string, double>& parameters,
                   const Record& record);

/// The same as a filter on the vehicle knows it at every row of a track of this model and record:
/// by the states and biases of that row. Segments are what the track has of them.
Record reconstruct(const StateBlockModel& path, const Track& track, const Record& record);

}  // namespace sepcal
