// SPDX-License-Identifier: BSD-3-Clause
// A joint fit's result by names: shared parameters, flights with their own, departures, noise, and
// what stays open.
#pragma once

#include <string>
#include <vector>

#include "many/joint_covariance.hpp"
#include "many/joint_stage.hpp"
#include "many/many_objective.hpp"
#include "sepcal/fit_many.hpp"

namespace sepcal::many {

/// Fills `result` but for the flights left out. `names`: of the source's flights.
void describe_many(const BlockModel& model, const JointProblem& joint, const JointStage& stage,
                   const ManyObjective& objective, const JointCovariance& covariance,
                   const std::vector<std::string>& names, ManyFit& result);

}  // namespace sepcal::many
