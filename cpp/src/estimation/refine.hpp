// SPDX-License-Identifier: BSD-3-Clause
// The last digits of a minimum: Gauss-Newton steps within the bounds, or Newton's where those don't
// contract. A comparison of costs, which is all that a descent has, can't place a minimum better
// than the square root of the rounding unit.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "estimation/minimise.hpp"

namespace sepcal::estimation {

struct Refinement {
  Eigen::VectorXd x;
  std::vector<bool> at_bound;  // x lies on a bound and the cost falls beyond it
  bool converged = false;
  int iterations = 0;
};

/// Steps until one is shorter than 1e-12 (1 + |r|) standard errors, r the whitened residual, or
/// than 1e-14 of `scale`, the parameters' plausible lengths (without noise, standard errors are as
/// small as rounding). Where rounding stops the steps from shrinking before that, 1e-3 standard
/// errors or 1e-9 of `scale` still pass. Else not converged, and x is `start`: there is no minimum
/// near, or the model is not finite. The objective was linearised last at x.
Refinement refine(Objective& objective, const Eigen::VectorXd& start, const numerics::Box& box,
                  const Eigen::VectorXd& scale);

/// The same without Newton's steps, which take a pass for each parameter, and converged only where
/// the cost is no higher than at `start`. Unless converged, x and the objective are anywhere.
Refinement refine_downhill(Objective& objective, const Eigen::VectorXd& start,
                           const numerics::Box& box, const Eigen::VectorXd& scale);

}  // namespace sepcal::estimation
