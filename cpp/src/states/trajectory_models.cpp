// SPDX-License-Identifier: BSD-3-Clause
// The state models that sepcal brings, compiled once: who fits them doesn't differentiate them
// again.
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/models/flight_path.hpp"
#include "sepcal/models/short_period.hpp"

namespace sepcal {

template class TrajectoryModel<FlightPath>;
template class TrajectoryModel<FlightPathWithPosition>;
template class TrajectoryModel<ShortPeriod>;

}  // namespace sepcal
