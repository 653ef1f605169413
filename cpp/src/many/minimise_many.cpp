// SPDX-License-Identifier: BSD-3-Clause
#include "many/minimise_many.hpp"

#include <ceres/cost_function.h>
#include <ceres/evaluation_callback.h>
#include <ceres/ordered_groups.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <cmath>
#include <exception>
#include <list>
#include <memory>
#include <utility>

namespace sepcal::many {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Takes the source to the point at hand before any flight is asked. An exception must not pass
/// through Ceres: it is kept, and every evaluation fails from then on.
class Visit final : public ceres::EvaluationCallback {
 public:
  Visit(ManyObjective& objective, const VectorXd& x) : objective_(objective), x_(x) {}

  void PrepareForEvaluation(bool /*evaluate_jacobians*/, bool /*new_evaluation_point*/) override {
    if (failure_) return;
    try {
      finite_ = objective_.linearise(x_);
    } catch (...) {
      failure_ = std::current_exception();
    }
  }

  bool is_good() const { return finite_ && !failure_; }

  void throw_again() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  ManyObjective& objective_;
  const VectorXd& x_;
  bool finite_ = true;
  std::exception_ptr failure_;
};

class FlightCost final : public ceres::CostFunction {
 public:
  FlightCost(const ManyObjective& objective, const Visit& visit, Index flight)
      : objective_(objective), visit_(visit), flight_(static_cast<std::size_t>(flight)) {
    const Layout& layout = objective.layout();
    for (const Index size : {layout.own, layout.shared}) {
      if (size > 0) mutable_parameter_block_sizes()->push_back(static_cast<int>(size));
    }
    set_num_residuals(static_cast<int>(layout.own + layout.shared + 1));
  }

  bool Evaluate(double const* const* /*parameters*/, double* residuals,
                double** jacobians) const override {
    if (!visit_.is_good()) return false;
    const MatrixXd& T = objective_.blocks()[flight_].matrix();
    Eigen::Map<VectorXd>(residuals, T.rows()) = T.col(T.cols() - 1);
    if (jacobians == nullptr) return true;
    Index first = 0;
    for (std::size_t block = 0; block < parameter_block_sizes().size(); ++block) {
      const Index size = parameter_block_sizes()[block];
      if (jacobians[block] != nullptr) {
        using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        if (size == 1) {
          Eigen::Map<VectorXd>(jacobians[block], T.rows()) = -T.col(first);
        } else {
          Eigen::Map<RowMajor>(jacobians[block], T.rows(), size) = -T.middleCols(first, size);
        }
      }
      first += size;
    }
    return true;
  }

 private:
  const ManyObjective& objective_;
  const Visit& visit_;
  std::size_t flight_;
};

void set_bounds(ceres::Problem& problem, double* block, Index size, const numerics::Box& box,
                Index first) {
  for (Index k = 0; k < size; ++k) {
    const int index = static_cast<int>(k);
    const double lower = box.lower[first + k];
    const double upper = box.upper[first + k];
    if (std::isfinite(lower)) problem.SetParameterLowerBound(block, index, lower);
    if (std::isfinite(upper)) problem.SetParameterUpperBound(block, index, upper);
  }
}

ceres::Solver::Options solver_options(int iterations) {
  ceres::Solver::Options options;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.max_num_iterations = iterations;
  options.function_tolerance = 1e-12;
  options.gradient_tolerance = 0.0;
  options.parameter_tolerance = 1e-14;
  return options;
}

}  // namespace

estimation::Descent minimise_many(ManyObjective& objective, const VectorXd& start,
                                  const numerics::Box& box, int iterations) {
  const Layout& layout = objective.layout();
  estimation::Descent descent{.x = box.clip(start)};
  Visit visit(objective, descent.x);

  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.evaluation_callback = &visit;
  ceres::Problem problem(ownership);
  std::list<FlightCost> costs;
  const auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  double* shared = descent.x.data() + layout.flights * layout.own;
  for (Index i = 0; i < layout.flights; ++i) {
    double* own = descent.x.data() + i * layout.own;
    std::vector<double*> blocks{own, shared};
    if (layout.own == 0) blocks.erase(blocks.begin());
    costs.emplace_back(objective, visit, i);
    problem.AddResidualBlock(&costs.back(), nullptr, blocks);
    if (layout.own == 0) continue;
    ordering->AddElementToGroup(own, 0);
    set_bounds(problem, own, layout.own, box, i * layout.own);
  }
  ordering->AddElementToGroup(shared, 1);
  set_bounds(problem, shared, layout.shared, box, layout.flights * layout.own);

  ceres::Solver::Options solver = solver_options(iterations);
  solver.linear_solver_type = layout.own == 0 ? ceres::DENSE_QR : ceres::DENSE_SCHUR;
  if (layout.own > 0) solver.linear_solver_ordering = ordering;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  visit.throw_again();

  descent.square = 2.0 * summary.final_cost;
  descent.converged = summary.termination_type == ceres::CONVERGENCE;
  descent.iterations = static_cast<int>(summary.iterations.size());
  return descent;
}

}  // namespace sepcal::many
