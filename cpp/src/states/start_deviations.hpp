// SPDX-License-Identifier: BSD-3-Clause
// The state where a trajectory begins, and how well filters that run along records know it there.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sepcal/detail/states/state_steps.hpp"
#include "sepcal/record.hpp"

namespace sepcal::states {

/// x (n_x) where a trajectory begins, at xi (n).
Eigen::VectorXd start_of(const TrajectoryPlan& plan, int trajectory, const Eigen::VectorXd& xi);

/// Standard deviations (n_x) of x at a segment's start. Of states without one that is given, ten
/// times the largest value that the state has on the way from there: as good as unknown.
Eigen::VectorXd start_deviations(const StateSteps& steps, const Segment& segment,
                                 const Eigen::VectorXd& x, const std::vector<std::string>& names,
                                 const std::map<std::string, double>& given);

}  // namespace sepcal::states
