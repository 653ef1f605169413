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

/// A refining step's verdict: how long it is, in standard errors and in plausible lengths, and
/// whether that is as short as rounding allows.
struct StepLength {
  double size = 0.0;      // |J step|, in standard errors
  double relative = 0.0;  // the largest entry of the step over the parameter's plausible length
  double residual = 0.0;  // |r|, whitened

  StepLength(double size_, const Eigen::VectorXd& step, const Eigen::VectorXd& scale,
             double residual_)
      : size(size_),
        relative(step.cwiseQuotient(scale).cwiseAbs().maxCoeff()),
        residual(residual_) {}

  bool is_last_digit() const { return size <= 1e-12 * (1.0 + residual) || relative <= 1e-14; }
  bool is_passable() const { return size <= 1e-3 || relative <= 1e-9; }
};

/// Steps until one is shorter than 1e-12 (1 + |r|) standard errors, r the whitened residual, or
/// than 1e-14 of `scale`, the parameters' plausible lengths (without noise, standard errors are as
/// small as rounding). Where rounding stops the steps from shrinking before that, 1e-3 standard
/// errors or 1e-9 of `scale` still pass, and so does a step that is no longer than `share` of the
/// first. Else not converged, and x is `start`: there is no minimum near, or the model is not
/// finite. The objective was linearised last at x.
Refinement refine(Objective& objective, const Eigen::VectorXd& start, const numerics::Box& box,
                  const Eigen::VectorXd& scale, double share = 0.0);

/// The same without Newton's steps, which take a pass for each parameter, and converged only where
/// the cost is no higher than at `start`. Unless converged, x and the objective are anywhere.
Refinement refine_downhill(Objective& objective, const Eigen::VectorXd& start,
                           const numerics::Box& box, const Eigen::VectorXd& scale);

}  // namespace sepcal::estimation
