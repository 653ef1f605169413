// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/global_search.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <nlopt.hpp>
#include <utility>

#include "sepcal/error.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Values = std::vector<double>;

constexpr double beyond_any_logarithm = 1e3;  // |ln S| < 745 for every double S

Values values_in(const VectorXd& x) { return {x.begin(), x.end()}; }

/// S as NLopt sees it.
double logarithm(double square) {
  if (!std::isfinite(square)) return beyond_any_logarithm;
  return std::log(std::max(square, std::numeric_limits<double>::min()));
}

/// ln S and its gradient as one of NLopt's functions, of x in units of `widths`.
class LogarithmicCost {
 public:
  LogarithmicCost(Objective& objective, VectorXd origin, VectorXd widths)
      : objective_(objective), origin_(std::move(origin)), widths_(std::move(widths)) {}

  VectorXd point(const Values& t) const {
    return origin_ + widths_.cwiseProduct(Map<const VectorXd>(t.data(), origin_.size()));
  }

  /// The lowest point so far.
  const Descent& lowest() const { return lowest_; }

  void hear(std::function<void(const VectorXd&, double)> on_point) {
    on_point_ = std::move(on_point);
  }

  /// Runs the solver from t. An exception of the model stops it and is thrown again here: NLopt is
  /// written in C and lets none through. False where the solver ran out of evaluations or failed.
  bool minimise(nlopt::opt& solver, Values t) {
    solver.set_min_objective(&LogarithmicCost::evaluate, this);
    bool converged = false;
    try {
      double value = 0.0;
      converged = solver.optimize(t, value) != nlopt::MAXEVAL_REACHED;
    } catch (const nlopt::forced_stop&) {
      std::rethrow_exception(failure_);
    } catch (const nlopt::roundoff_limited&) {
      converged = true;  // no better point can be told from the best one
    } catch (const std::exception&) {
      converged = false;  // the best point stands
    }
    return converged;
  }

 private:
  static double evaluate(const Values& t, Values& gradient, void* self) {
    auto& cost = *static_cast<LogarithmicCost*>(self);
    try {
      return cost.at(t, gradient);
    } catch (...) {
      cost.failure_ = std::current_exception();
      throw nlopt::forced_stop();
    }
  }

  double at(const Values& t, Values& gradient) {
    const VectorXd x = point(t);
    const double square = gradient.empty() ? objective_.square(x) : differentiate(x, gradient);
    if (square < lowest_.square) {
      lowest_.x = x;
      lowest_.square = square;
    }
    ++lowest_.iterations;
    if (on_point_) on_point_(x, square);
    return logarithm(square);
  }

  /// S, and d ln S / dt = 2 J'r / S times the widths.
  double differentiate(const VectorXd& x, Values& gradient) {
    VectorXd residual;
    MatrixXd jacobian;
    std::ranges::fill(gradient, 0.0);
    if (!objective_.linearise(x, residual, jacobian)) return infinity;
    const double square = residual.squaredNorm();
    if (square >= std::numeric_limits<double>::min()) {
      Map<VectorXd>(gradient.data(), x.size()) =
          (2.0 / square) * widths_.cwiseProduct(jacobian.transpose() * residual);
    }
    return square;
  }

  Objective& objective_;
  VectorXd origin_;
  VectorXd widths_;
  Descent lowest_{{}, infinity};
  std::function<void(const VectorXd&, double)> on_point_;
  std::exception_ptr failure_;
};

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
  LogarithmicCost cost(objective, from, widths);
  nlopt::opt solver(nlopt::LD_SLSQP, n);
  solver.set_lower_bounds(
      values_in((box.lower - from).cwiseQuotient(widths).cwiseMax(-reach).cwiseMin(0.0)));
  solver.set_upper_bounds(
      values_in((box.upper - from).cwiseQuotient(widths).cwiseMin(reach).cwiseMax(0.0)));
  constexpr int most_evaluations = 200;
  solver.set_maxeval(most_evaluations);
  solver.set_ftol_abs(1e-10);
  solver.set_xtol_abs(1e-8);
  const bool converged = cost.minimise(solver, Values(n, 0.0));
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
  LogarithmicCost cost(objective, box.lower, box.upper - box.lower);
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
  cost.minimise(solver, Values(static_cast<std::size_t>(n), 0.5));
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
