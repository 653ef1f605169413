// SPDX-License-Identifier: BSD-3-Clause
// The one door to Ceres: a bounded Levenberg-Marquardt descent of a compressed objective.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "estimation/objective.hpp"
#include "numerics/box.hpp"

namespace sepcal::estimation {

struct Descent {
  Eigen::VectorXd x;
  double square = 0.0;  // sum of whitened squares at x
  bool converged = false;
  bool left_off = false;  // as is_known() said
  int iterations = 0;
};

/// Whether a descent at x (n), the sum of squares there, needs no end of its own.
using IsKnown = std::function<bool(const Eigen::VectorXd& x, double square)>;

struct DescentOptions {
  int iterations = 200;  // at most; more: not converged
  double function_tolerance =
      1e-12;  // ends when a step changes the sum S by less than this times S
  /// Levenberg-Marquardt's first radius. Large: the first step is Gauss-Newton's. Below 1: it is a
  /// fraction of that, so that a descent ends in the basin that it began in.
  double first_radius = 1e4;
  IsKnown is_known = {};  // asked after each step
};

/// x stays within the box; the start is clipped to it.
Descent minimise(Objective& objective, const Eigen::VectorXd& start, const numerics::Box& box,
                 const DescentOptions& options);

}  // namespace sepcal::estimation
