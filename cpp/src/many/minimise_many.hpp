// SPDX-License-Identifier: BSD-3-Clause
// The descent of many flights, in Ceres as minimise.cpp's: one residual block a flight over its own
// and the shared parameters; own ones are eliminated first (Schur complement), and one callback a
// point brings all flights' factors at once. With it, the last digits.
#pragma once

#include <Eigen/Core>

#include "estimation/minimise.hpp"
#include "estimation/refine.hpp"
#include "many/many_objective.hpp"

namespace sepcal::many {

/// x stays within the box; the start is clipped to it. What the source throws is thrown again.
estimation::Descent minimise_many(ManyObjective& objective, const Eigen::VectorXd& start,
                                  const numerics::Box& box, int iterations);

/// Gauss-Newton steps on the arrowhead, within the bounds, to refine()'s last digit. Where they
/// don't contract x is `start`, not converged.
estimation::Refinement refine_many(ManyObjective& objective, const Eigen::VectorXd& start,
                                   const numerics::Box& box, const Eigen::VectorXd& scale);

}  // namespace sepcal::many
