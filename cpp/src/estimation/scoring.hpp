// SPDX-License-Identifier: BSD-3-Clause
// Fisher scoring (system identification summary, S 5.8 to 5.11): the minimum of V_m over the free
// ones of theta within their bounds, by steps that the triangular factor of the score rows gives.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "estimation/objective.hpp"
#include "numerics/box.hpp"
#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/detail/triangular_factor.hpp"

namespace sepcal::estimation {

struct Scoring {
  const ScoredLikelihood& model;
  std::vector<Eigen::Index> free;  // k places in theta
  numerics::Box box;               // of theta
  Prior prior;                     // of theta, weight 0: none
  int iterations = 100;            // at most
  /// Ends where a step within the bounds promises to lower V_m by no more, or the step after it
  /// would, by how steps contract: its factor is then that of a step before.
  double promise = 1e-13;
  std::function<void(int iteration)> progress = {};  // may be empty
};

struct Scored {
  Eigen::VectorXd theta;
  double cost = 0.0;           // V_m, without the prior's part; infinite where the filter failed
  std::size_t readings = 0;    // outputs that were there
  std::size_t row = 0;         // where the filter failed
  TriangularFactor factor{0};  // k + 1 columns: [score rows | residual], with the prior's
  std::vector<bool> at_bound;  // k: V_m would fall beyond the bound
  bool converged = false;
  int iterations = 0;
};

/// V_m with the prior of what is free.
double cost_with_prior(const Scoring& scoring, const Scored& at);

/// theta's factor at a point, no step taken.
Scored score_at(const Scoring& scoring, const Eigen::VectorXd& theta);

/// From theta, which is clipped to the box. Logarithms of noises move by at most 1 a step; one that
/// falls and falls goes farther, as far as its lower bound, where V_m is lower there.
Scored minimise_by_scoring(const Scoring& scoring, const Eigen::VectorXd& theta);

/// V_m's second derivatives (k x k) by central differences of the gradient, with the prior's, at
/// the end of a scoring; not finite where the filter fails on the way.
Eigen::MatrixXd observed_hessian(const Scoring& scoring, const Scored& at);

/// From there by steps of Newton and Raphson (S 5.9) with that Hessian, as long as it is positive
/// definite and V_m falls.
Scored finish_by_newton(const Scoring& scoring, Scored at);

}  // namespace sepcal::estimation
