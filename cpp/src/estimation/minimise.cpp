// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/minimise.hpp"

#include <ceres/cost_function.h>
#include <ceres/iteration_callback.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <cmath>
#include <exception>

#include "sepcal/detail/solver_log.hpp"

namespace sepcal {

using namespace estimation;  // this room's own

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Ceres asks a trial point for its cost alone: the record's norm then stands in one residual, and
/// no factor is built. An exception must not pass through Ceres: it is kept, and every evaluation
/// fails from then on.
class CompressedCost final : public ceres::CostFunction {
 public:
  explicit CompressedCost(Objective& objective)
      : objective_(objective), tried_(VectorXd::Constant(objective.parameters(), not_a_number)) {
    set_num_residuals(objective.residuals());
    mutable_parameter_block_sizes()->push_back(objective.parameters());
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    if (failure_) return false;
    try {
      return evaluate(parameters, residuals, jacobians);
    } catch (...) {
      failure_ = std::current_exception();
      return false;
    }
  }

  void throw_again() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  bool evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
    const VectorXd x = Eigen::Map<const VectorXd>(parameters[0], objective_.parameters());
    Eigen::Map<VectorXd> residual(residuals, objective_.residuals());
    if (jacobians == nullptr || jacobians[0] == nullptr) {
      if (x != tried_) square_ = objective_.square(x);
      tried_ = x;
      residual.setZero();
      residual[0] = std::sqrt(square_);
      return std::isfinite(square_);
    }
    VectorXd r;
    MatrixXd jacobian;
    if (!objective_.linearise(x, r, jacobian)) return false;
    residual = r;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor>(jacobians[0], jacobian.rows(), jacobian.cols()) = jacobian;
    return true;
  }

  Objective& objective_;
  mutable VectorXd tried_;  // the line search and the step after it ask for one point
  mutable double square_ = 0.0;
  mutable std::exception_ptr failure_;
};

/// Leaves off where the descent's end is known already.
class LeaveOff final : public ceres::IterationCallback {
 public:
  LeaveOff(const IsKnown& is_known, const VectorXd& x) : is_known_(is_known), x_(x) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (!summary.step_is_successful || summary.iteration == 0) return ceres::SOLVER_CONTINUE;
    left_off_ = is_known_(x_, 2.0 * summary.cost);
    return left_off_ ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

  bool left_off() const { return left_off_; }

 private:
  const IsKnown& is_known_;
  const VectorXd& x_;
  bool left_off_ = false;
};

void set_bounds(ceres::Problem& problem, double* x, const numerics::Box& box) {
  for (Index k = 0; k < box.lower.size(); ++k) {
    const int index = static_cast<int>(k);
    if (std::isfinite(box.lower[k])) problem.SetParameterLowerBound(x, index, box.lower[k]);
    if (std::isfinite(box.upper[k])) problem.SetParameterUpperBound(x, index, box.upper[k]);
  }
}

}  // namespace

Descent estimation::minimise(Objective& objective, const VectorXd& start, const numerics::Box& box,
                             const DescentOptions& options) {
  Descent descent;
  descent.x = box.clip(start);
  if (objective.parameters() == 0) {
    descent.square = objective.square(descent.x);
    descent.converged = std::isfinite(descent.square);
    return descent;
  }

  CompressedCost cost(objective);
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  problem.AddResidualBlock(&cost, nullptr, descent.x.data());
  set_bounds(problem, descent.x.data(), box);

  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.logging_type = ceres::SILENT;
  solver.num_threads = 1;
  solver.max_num_iterations = options.iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.initial_trust_region_radius = options.first_radius;
  solver.gradient_tolerance = 0.0;
  solver.parameter_tolerance = 1e-14;
  solver.line_search_interpolation_type = ceres::QUADRATIC;  // CUBIC asks trials for a gradient
  LeaveOff leave_off(options.is_known, descent.x);
  if (options.is_known) {
    solver.callbacks.push_back(&leave_off);
    solver.update_state_every_iteration = true;
  }
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  cost.throw_again();

  descent.square = 2.0 * summary.final_cost;
  descent.converged = summary.termination_type == ceres::CONVERGENCE;
  descent.left_off = leave_off.left_off();
  descent.iterations = static_cast<int>(summary.iterations.size());
  return descent;
}

}  // namespace sepcal
