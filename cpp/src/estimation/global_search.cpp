// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/global_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlopt.hpp>

#include "estimation/nlopt_cost.hpp"
#include "sepcal/error.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double beyond_any_logarithm = 1e3;  // |ln S| < 745 for every double S

/// ln S: its dips are ratios.
struct Logarithm final : SquareScale {
  double value(double square) const override {
    if (!std::isfinite(square)) return beyond_any_logarithm;
    return std::log(std::max(square, std::numeric_limits<double>::min()));
  }
  double slope(double square) const override {
    return square < std::numeric_limits<double>::min() ? 0.0 : 1.0 / square;
  }
};

const Logarithm logarithm;

numerics::Box finite_box(const std::vector<Variable>& parameters) {
  const auto n = static_cast<Index>(parameters.size());
  numerics::Box box{VectorXd(n), VectorXd(n)};
  for (Index k = 0; k < n; ++k) {
    const Variable& parameter = parameters[static_cast<std::size_t>(k)];
    if (!std::isfinite(parameter.lower) || !std::isfinite(parameter.upper)) {
      throw Error("nonlinear parameter '" + parameter.name +
                  "' has no finite bounds for a global search; give it bounds or search among "
                  "samples");
    }
    box.lower[k] = parameter.lower;
    box.upper[k] = parameter.upper;
  }
  return box;
}

/// One try of a descent: within `reach` widths of `from`, and within the box.
Descent descend_within(Objective& objective, const VectorXd& from, const numerics::Box& box,
                       const VectorXd& widths, double reach) {
  const auto n = static_cast<unsigned>(from.size());
  NloptCost cost(objective, logarithm, from, widths);
  nlopt::opt solver(nlopt::LD_SLSQP, n);
  solver.set_lower_bounds(
      values_in((box.lower - from).cwiseQuotient(widths).cwiseMax(-reach).cwiseMin(0.0)));
  solver.set_upper_bounds(
      values_in((box.upper - from).cwiseQuotient(widths).cwiseMin(reach).cwiseMax(0.0)));
  constexpr int most_evaluations = 200;
  solver.set_maxeval(most_evaluations);
  solver.set_ftol_abs(1e-10);
  solver.set_xtol_abs(1e-8);
  const bool converged = cost.minimise(solver, std::vector<double>(n, 0.0));
  Descent descent = cost.lowest();
  if (descent.x.size() == 0) descent.x = from;
  descent.x = box.clip(descent.x);
  descent.converged = converged && std::isfinite(descent.square);
  return descent;
}

}  // namespace

SearchedPoints search_globally(Objective& objective, const std::vector<Variable>& parameters,
                               int evaluations, const std::function<void(double)>& on_progress) {
  const numerics::Box box = finite_box(parameters);
  const auto n = static_cast<Index>(parameters.size());
  SearchedPoints searched{MatrixXd(n, evaluations), VectorXd(evaluations)};
  Index count = 0;
  NloptCost cost(objective, logarithm, box.lower, box.upper - box.lower);
  cost.hear([&](const VectorXd& x, double square) {
    if (count == evaluations) return;
    searched.points.col(count) = box.clip(x);
    searched.squares[count++] = square;
    if (on_progress) on_progress(static_cast<double>(count) / evaluations);
  });
  nlopt::opt solver(nlopt::GN_DIRECT, static_cast<unsigned>(n));
  solver.set_lower_bounds(0.0);
  solver.set_upper_bounds(1.0);
  solver.set_maxeval(evaluations);
  cost.minimise(solver, std::vector<double>(static_cast<std::size_t>(n), 0.5));
  searched.points.conservativeResize(n, count);
  searched.squares.conservativeResize(count);
  if (on_progress && count < evaluations) on_progress(1.0);
  return searched;
}

Descent descend(Objective& objective, const VectorXd& start, const numerics::Box& box,
                const VectorXd& widths) {
  constexpr double first_reach = 0.05;
  constexpr double edge = 1e-6;  // of the reach
  Descent descent;
  descent.x = box.clip(start);
  int evaluations = 0;
  constexpr int most_tries = 7;  // the last reaches over the whole box
  double reach = first_reach;
  for (int i = 0; i < most_tries; ++i, reach *= 2.0) {
    const VectorXd from = descent.x;
    descent = descend_within(objective, from, box, widths, reach);
    evaluations += descent.iterations;
    const VectorXd moved = (descent.x - from).cwiseQuotient(widths).cwiseAbs();
    if (!(moved.maxCoeff() >= reach * (1.0 - edge))) break;
  }
  descent.iterations = evaluations;
  return descent;
}

}  // namespace sepcal::estimation
