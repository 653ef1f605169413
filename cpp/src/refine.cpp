// SPDX-License-Identifier: BSD-3-Clause
#include "refine.hpp"

#include <cmath>

#include "bounded_least_squares.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int most_steps = 60;
constexpr double smallest_step = 1e-12;  // standard errors, times 1 + |r|
constexpr double passable_step = 1e-3;
constexpr double smallest_relative_step = 1e-14;  // of the plausible lengths
constexpr double passable_relative_step = 1e-9;

/// Which parameters lie on a bound that `pull`, the negative gradient, pushes them against.
std::vector<bool> held_by_bounds(const VectorXd& x, const VectorXd& pull, const Box& box) {
  std::vector<bool> held;
  for (Index k = 0; k < x.size(); ++k) {
    held.push_back((x[k] <= box.lower[k] && pull[k] <= 0) ||
                   (x[k] >= box.upper[k] && pull[k] >= 0));
  }
  return held;
}

}  // namespace

Refinement refine(Objective& objective, const VectorXd& start, const Box& box,
                  const VectorXd& scale) {
  Refinement result{box.clip(start), std::vector<bool>(static_cast<std::size_t>(start.size()))};
  VectorXd residual;
  MatrixXd jacobian;
  double before = infinity;
  for (; result.iterations < most_steps; ++result.iterations) {
    if (!objective.linearise(result.x, residual, jacobian)) break;
    const BoundedSolution step =
        solve_bounded(-jacobian, residual, {box.lower - result.x, box.upper - result.x});
    const double size = (jacobian * step.x).stableNorm();
    const double relative = step.x.cwiseQuotient(scale).cwiseAbs().maxCoeff();
    const bool last_digit =
        size <= smallest_step * (1.0 + residual.stableNorm()) || relative <= smallest_relative_step;
    const bool passable = size <= passable_step || relative <= passable_relative_step;
    if (last_digit || (passable && size >= before)) {
      result.at_bound = step.active;
      for (Index k = 0; k < start.size(); ++k) {
        if (step.active[static_cast<std::size_t>(k)]) result.x[k] += step.x[k];  // onto its bound
      }
      result.x = box.clip(result.x);
      result.converged = true;
      return result;
    }
    if (!(size < before)) break;
    before = size;
    result.x = box.clip(result.x + step.x);
  }
  result.x = box.clip(start);
  if (objective.linearise(result.x, residual, jacobian)) {
    result.at_bound = held_by_bounds(result.x, -jacobian.transpose() * residual, box);
  }
  return result;
}

}  // namespace sepcal
