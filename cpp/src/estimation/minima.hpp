// SPDX-License-Identifier: BSD-3-Clause
// Step 4: the distinct local minima of the profile cost, by descents from the deepest basins of its
// samples, and the directions along which the lowest one is a valley and no point.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "estimation/minimise.hpp"
#include "estimation/objective.hpp"
#include "estimation/problem.hpp"
#include "sepcal/detail/stage_one.hpp"

namespace sepcal::estimation {

/// Lengths by which xi2 is measured (n_2): half the width of the bounds, or two standard deviations
/// of an unbounded parameter's sampling distribution.
Eigen::VectorXd half_widths(const Problem& problem);

/// From a start (n_2) to where the cost is lowest nearby, within the bounds; may leave off where
/// `is_known` says so, and ends where a step changes the sum of squares by less than `tolerance` of
/// it.
using Descend =
    std::function<Descent(const Eigen::VectorXd& start, const IsKnown& is_known, double tolerance)>;

/// Lowest first; of options.descents at most, and of one from each of the model's `guesses` (n_2 x
/// any number). `samples` is n_2 x S, `squares` (S): the sum of squares there, infinite where no
/// descent may begin. No descent begins where samples show the neighbourhood of a minimum that is
/// known. Ends are refined, and two of them are one where the record can't tell them apart.
/// `measurements`: rows x outputs.
std::vector<Descent> find_minima(Objective& objective, const Problem& problem,
                                 const Eigen::MatrixXd& samples, const Eigen::VectorXd& squares,
                                 const Eigen::MatrixXd& guesses, double measurements,
                                 const Descend& descend);

/// Directions, in words, along which a half width from xi2 moves the fit by less than two standard
/// errors.
std::vector<std::string> describe_flat_directions(Objective& objective, const Problem& problem,
                                                  const Eigen::VectorXd& xi2, double measurements);

/// A sentence on the other minima whose residuals are less than twice as large as the lowest's: a
/// model that lacks something may fit best at the wrong one. Empty where there is none.
std::string describe_other_minima(const Problem& problem, const std::vector<LocalMinimum>& minima);

}  // namespace sepcal::estimation
