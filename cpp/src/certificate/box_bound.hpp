// SPDX-License-Identifier: BSD-3-Clause
// What the cost is at least where xi2 is within a box, of all xi1 at once: the model to second
// order about the middle, its products relaxed, and the linear least squares that is left bounded
// from below by weak duality, in ranges.
#pragma once

#include <Eigen/Core>

#include "certificate/enclosed_problem.hpp"

namespace sepcal::certificate {

struct BoxBound {
  double lower = 0.0;           // of J, or `most` where that is less
  Eigen::VectorXd middle = {};  // of the box, n_2
  Eigen::VectorXd xi1 = {};     // of least squares there, within its limits: a guess
  Eigen::VectorXd swing = {};   // n_2, how far each parameter moves the rows within the box
  Eigen::VectorXd reach = {};   // n_1, proven: |xi1 - that| at most, where J is at most `most`
};

/// Of xi1 within `limits` (n_1), where J is at most `most`.
BoxBound bound_over(const EnclosedProblem& problem, const Ranges& box, const Ranges& limits,
                    double most);

}  // namespace sepcal::certificate
