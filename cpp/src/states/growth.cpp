// SPDX-License-Identifier: BSD-3-Clause
// How fast errors of a state grow along trajectories, which says where they can't be integrated.
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "sepcal/states/state_steps.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// x where a trajectory begins, n_x.
VectorXd start_of(const TrajectoryPlan& plan, int trajectory, const VectorXd& xi) {
  const std::vector<int>& states = plan.integrated();
  VectorXd x(static_cast<Index>(states.size()));
  for (Index i = 0; i < x.size(); ++i) {
    x[i] = xi[plan.column_of_start(states[static_cast<std::size_t>(i)], trajectory)];
  }
  return x;
}

double largest_eigenvalue(const MatrixXd& A) {
  if (!A.allFinite()) return infinity;
  return A.eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace

double StateBlockModel::growth(const Record& record, const VectorXd& xi) const {
  const std::unique_ptr<StateSteps> along = steps(record, xi);
  const auto n_x = static_cast<Index>(plan().integrated().size());
  double most = 1.0;
  for (const Segment& segment : record.segments()) {
    VectorXd x = VectorXd::Zero(n_x);
    MatrixXd grown = MatrixXd::Identity(n_x, n_x);
    for (std::size_t row = segment.first; row + 1 < segment.last; ++row) {
      const int trajectory = plan().trajectory_at(row, row == segment.first);
      if (trajectory >= 0) {
        most = std::max(most, largest_eigenvalue(grown));
        x = start_of(plan(), trajectory, xi);
        grown.setIdentity();
      }
      const StateSteps::Step step = along->advance(row, x);
      x = step.x;
      grown = step.Phi * grown;
    }
    most = std::max(most, largest_eigenvalue(grown));
  }
  return most;
}

}  // namespace sepcal
