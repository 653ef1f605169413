// SPDX-License-Identifier: BSD-3-Clause
// The test of departure: a flight's own estimate of the shared parameters against that of all the
// others, off the factors at the joint solution.
//   In coordinates where all flights carry the information I, flight i carries L = B'B and the
//   others I - L. b = B'q is its score at the joint solution, the others' is -b. Its own estimate
//   lies L^-1 b from the joint one, theirs -(I - L)^-1 b, and the difference (L (I - L))^-1 b is
//   tested by b' C^-1 b, C = (I - L) M_i (I - L) + L M_others L the covariance of b, M of scores.
//   Eigenvectors of L that only one side determines are left out.
#pragma once

#include <vector>

#include "many/joint_covariance.hpp"
#include "sepcal/fit_many.hpp"

namespace sepcal::many {

/// One a flight, in their order; differences in the order of the free shared parameters. White:
/// F where R was estimated beside, exact for one output and a linear model.
std::vector<Departure> find_departures(const Compared& compared, const JointCovariance& covariance);

}  // namespace sepcal::many
