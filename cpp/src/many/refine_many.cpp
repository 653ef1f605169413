// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "estimation/refine.hpp"
#include "many/arrowhead.hpp"
#include "many/minimise_many.hpp"
#include "numerics/bounded_least_squares.hpp"

namespace sepcal::many {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Onto their bounds, to the last bit.
VectorXd put_on_bounds(VectorXd x, const numerics::BoundedSolution& step,
                       const numerics::Box& box) {
  for (Index k = 0; k < x.size(); ++k) {
    if (step.active[static_cast<std::size_t>(k)]) x[k] += step.x[k];
  }
  return box.clip(x);
}

}  // namespace

estimation::Refinement refine_many(ManyObjective& objective, const VectorXd& start,
                                   const numerics::Box& box, const VectorXd& scale) {
  constexpr int most_steps = 60;
  estimation::Refinement result{box.clip(start),
                                std::vector<bool>(static_cast<std::size_t>(start.size()))};
  double before = infinity;
  for (; result.iterations < most_steps; ++result.iterations) {
    if (!objective.linearise(result.x)) break;
    const Arrowhead arrowhead(objective.blocks(), objective.layout());
    const numerics::BoundedSolution step =
        numerics::solve_bounded(arrowhead, {box.lower - result.x, box.upper - result.x});
    const estimation::StepLength length(arrowhead.length_of(step.x), step.x, scale,
                                        arrowhead.residual());
    if (length.is_last_digit() || (length.is_passable() && length.size >= before)) {
      result.at_bound = step.active;
      result.x = put_on_bounds(std::move(result.x), step, box);
      result.converged = objective.linearise(result.x);
      return result;
    }
    if (!(length.size < before)) break;
    before = length.size;
    result.x = box.clip(result.x + step.x);
  }
  result.x = box.clip(start);
  if (objective.linearise(result.x)) {
    const VectorXd pull =
        Arrowhead(objective.blocks(), objective.layout()).pull(VectorXd::Zero(start.size()));
    for (Index k = 0; k < start.size(); ++k) {
      result.at_bound[static_cast<std::size_t>(k)] =
          (result.x[k] <= box.lower[k] && pull[k] <= 0) ||
          (result.x[k] >= box.upper[k] && pull[k] >= 0);
    }
  }
  return result;
}

}  // namespace sepcal::many
