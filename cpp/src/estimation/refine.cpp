// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/refine.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/bounded_least_squares.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/symmetric.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int most_steps = 60;

/// Which parameters lie on a bound that `pull`, the negative gradient, pushes them against.
std::vector<bool> held_by_bounds(const VectorXd& x, const VectorXd& pull,
                                 const numerics::Box& box) {
  std::vector<bool> held;
  for (Index k = 0; k < x.size(); ++k) {
    held.push_back((x[k] <= box.lower[k] && pull[k] <= 0) ||
                   (x[k] >= box.upper[k] && pull[k] >= 0));
  }
  return held;
}

/// The Hessian of half the sum of squares: differences of its exact gradient, over steps of a
/// hundredth of what the record can tell apart. Empty where the model is not finite.
MatrixXd hessian(Objective& objective, const VectorXd& x, const VectorXd& gradient,
                 const MatrixXd& jacobian, const VectorXd& scale) {
  constexpr double step = 1e-2;  // standard errors, of a parameter by itself
  VectorXd residual;
  MatrixXd tangent;
  MatrixXd H(x.size(), x.size());
  for (Index k = 0; k < x.size(); ++k) {
    const double length = jacobian.col(k).stableNorm();
    VectorXd moved = x;
    moved[k] += std::min(length > 0 ? step / length : infinity, 1e-4 * scale[k]);
    if (moved[k] == x[k] || !objective.linearise(moved, residual, tangent)) return {};
    H.col(k) = (tangent.transpose() * residual - gradient) / (moved[k] - x[k]);
  }
  return numerics::symmetric_part(H);
}

/// Newton's steps, for a minimum so curved that Gauss-Newton's don't contract there. The parameters
/// that bounds hold stay where they are.
bool refine_by_curvature(Objective& objective, Refinement& result, const numerics::Box& box,
                         const VectorXd& scale, double share) {
  constexpr int most_newton_steps = 15;
  VectorXd residual;
  MatrixXd jacobian;
  if (!objective.linearise(result.x, residual, jacobian)) return false;
  double first = infinity;
  double before = infinity;
  for (int i = 0; i < most_newton_steps; ++i, ++result.iterations) {
    const VectorXd gradient = jacobian.transpose() * residual;
    result.at_bound = held_by_bounds(result.x, -gradient, box);
    std::vector<Index> free;
    for (Index k = 0; k < result.x.size(); ++k) {
      if (!result.at_bound[static_cast<std::size_t>(k)]) free.push_back(k);
    }
    const MatrixXd H = hessian(objective, result.x, gradient, jacobian, scale);
    if (H.size() == 0) return false;
    const Eigen::LLT<MatrixXd> factor(H(free, free));
    if (factor.info() != Eigen::Success) return false;
    VectorXd step = VectorXd::Zero(result.x.size());
    const VectorXd inner = factor.solve(VectorXd(-gradient(free)));
    step(free) = inner;
    const VectorXd next = box.clip(result.x + step);
    const StepLength length((jacobian * step).stableNorm(), step, scale, residual.stableNorm());
    if (i == 0) first = length.size;
    if (length.is_last_digit() || (i > 0 && length.size <= share * first) ||
        (length.is_passable() && length.size >= before)) {
      return true;
    }
    if (!(length.size < before)) return false;
    before = length.size;
    result.x = next;
    if (!objective.linearise(result.x, residual, jacobian)) return false;
  }
  return false;
}

/// Sums of squares where steps began and ended.
struct Squares {
  double first = infinity;
  double last = infinity;
};

/// Gauss-Newton's steps while they contract. Unless they do to the end, x is left on the way.
bool refine_by_gauss_newton(Objective& objective, Refinement& result, const numerics::Box& box,
                            const VectorXd& scale, double share, Squares& squares) {
  VectorXd residual;
  MatrixXd jacobian;
  double first = infinity;
  double before = infinity;
  for (; result.iterations < most_steps; ++result.iterations) {
    if (!objective.linearise(result.x, residual, jacobian)) return false;
    squares.last = residual.squaredNorm();
    if (result.iterations == 0) squares.first = squares.last;
    const numerics::BoundedSolution step =
        numerics::solve_bounded(-jacobian, residual, {box.lower - result.x, box.upper - result.x});
    const StepLength length((jacobian * step.x).stableNorm(), step.x, scale, residual.stableNorm());
    if (result.iterations == 0) first = length.size;
    if (length.is_last_digit() || (result.iterations > 0 && length.size <= share * first) ||
        (length.is_passable() && length.size >= before)) {
      result.at_bound = step.active;
      for (Index k = 0; k < result.x.size(); ++k) {
        if (step.active[static_cast<std::size_t>(k)]) result.x[k] += step.x[k];  // onto its bound
      }
      result.x = box.clip(result.x);
      result.converged = true;
      return true;
    }
    if (!(length.size < before)) return false;
    before = length.size;
    result.x = box.clip(result.x + step.x);
  }
  return false;
}

Refinement begin(const VectorXd& start, const numerics::Box& box) {
  return {box.clip(start), std::vector<bool>(static_cast<std::size_t>(start.size()))};
}

}  // namespace

Refinement refine(Objective& objective, const VectorXd& start, const numerics::Box& box,
                  const VectorXd& scale, double share) {
  Refinement result = begin(start, box);
  Squares squares;
  if (refine_by_gauss_newton(objective, result, box, scale, share, squares)) return result;
  result.x = box.clip(start);
  VectorXd residual;
  MatrixXd jacobian;
  if (refine_by_curvature(objective, result, box, scale, share) &&
      objective.linearise(result.x, residual, jacobian)) {
    result.converged = true;
    return result;
  }
  result.x = box.clip(start);
  if (objective.linearise(result.x, residual, jacobian)) {
    result.at_bound = held_by_bounds(result.x, -jacobian.transpose() * residual, box);
  }
  return result;
}

Refinement refine_downhill(Objective& objective, const VectorXd& start, const numerics::Box& box,
                           const VectorXd& scale) {
  constexpr double rounding = 1e-9;  // of the sum
  Refinement result = begin(start, box);
  Squares squares;
  result.converged = refine_by_gauss_newton(objective, result, box, scale, 0.0, squares) &&
                     squares.last <= (1.0 + rounding) * squares.first;
  return result;
}

}  // namespace sepcal::estimation
