// SPDX-License-Identifier: BSD-3-Clause
// Where a joint fit begins: the flights' own fits, merged.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimation/minimise.hpp"
#include "many/many_objective.hpp"

namespace sepcal::many {

/// Two starts for the parameters of all flights, within the box: the shared ones as all flights'
/// factors weigh them, and their medians, which a single flight in another minimum can't move; a
/// flight's own ones follow to first order. Flights that did not converge by themselves count only
/// where none did. Those that are not finite are left out. `whitened`: a flight has one factor,
/// whitened, and not one an output.
std::vector<Eigen::VectorXd> joint_starts(const std::vector<FlightStart>& starts, bool whitened,
                                          const Layout& layout, const numerics::Box& box);

/// The better one. The objective has weights; it is linearised at the result.
Eigen::VectorXd find_joint_start(ManyObjective& objective, const std::vector<FlightStart>& starts,
                                 const numerics::Box& box);

/// R-hat by output (n_z standard deviations) of the flights' own fits together.
Eigen::VectorXd pooled_noise(const std::vector<FlightStart>& starts);

}  // namespace sepcal::many
