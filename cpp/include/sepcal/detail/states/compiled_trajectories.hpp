// SPDX-License-Identifier: BSD-3-Clause
// The models with a state that the library has compiled: who fits one of them and includes this
// need not compile it once more.
#pragma once

#include "sepcal/models/flight_path.hpp"
#include "sepcal/models/short_period.hpp"
#include "sepcal/states/trajectory_model.hpp"

namespace sepcal {

extern template class TrajectoryModel<FlightPath>;
extern template class TrajectoryModel<FlightPathWithPosition>;
extern template class TrajectoryModel<ShortPeriod>;

}  // namespace sepcal
