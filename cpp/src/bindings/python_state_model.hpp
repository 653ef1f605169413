// SPDX-License-Identifier: BSD-3-Clause
// A state model written in Python, laid along a record. A block's rows are walked in one call of
// Python (python/sepcal/walk.py), for all trajectories that are wanted side by side: those of
// differences, and those of several samples. Here its answers go to the columns of the plan.
#pragma once

#include <pybind11/pybind11.h>

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sepcal/detail/states/state_steps.hpp"
#include "sepcal/detail/states/trajectory_plan.hpp"

namespace sepcal::bindings {

namespace py = pybind11;

class PythonStateModel final : public StateBlockModel {
 public:
  /// `walk` is a sepcal.walk.Walk of the same tables and options. Throws Error where names clash.
  PythonStateModel(TrajectoryPlan plan, std::shared_ptr<const py::object> walk);

  const TrajectoryPlan& plan() const override { return plan_; }

  std::unique_ptr<StateSteps> steps(const Record& record, const Eigen::VectorXd& xi) const override;

  std::map<std::string, double> starting_values(const Record& record) const override;

  std::unique_ptr<Carry> new_carry() const override;

  /// Throws Error for arrays of another shape or kind than asked for; an exception of the model's
  /// own passes as it is.
  void evaluate(const Block& block, const double* xi2, const double* xi1, Carry* carry,
                Eigen::Ref<Eigen::MatrixXd> rows) const override;

  void evaluate_points(const Block& block, const Eigen::MatrixXd& points,
                       std::span<const std::unique_ptr<Carry>> carries, Eigen::MatrixXd& scratch,
                       const VisitRows& visit) const override;

 private:
  struct Path;
  struct Answer;
  class Steps;
  using Rows = Eigen::Ref<Eigen::MatrixXd>;

  py::object start_at(const Record& record, std::size_t row) const;
  Eigen::MatrixXd known_of(const Block& block) const;
  static Eigen::MatrixXd rows_at(const Eigen::MatrixXd& points, const std::vector<int>& columns);
  Eigen::MatrixXd p_at(const Eigen::MatrixXd& points) const;
  Eigen::MatrixXd linear_at(const Eigen::MatrixXd& points) const;
  Eigen::MatrixXd starts_at(const Eigen::MatrixXd& points, int trajectory) const;

  Answer walk(const Block& block, const Eigen::MatrixXd& points, bool tangent, Path& path) const;
  void place(const Block& block, const Answer& answer, Eigen::Index point,
             const Eigen::VectorXd& xi, Rows rows) const;

  TrajectoryPlan plan_;
  std::shared_ptr<const py::object> walk_;  // of share()
};

}  // namespace sepcal::bindings
