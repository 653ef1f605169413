// SPDX-License-Identifier: BSD-3-Clause
// What a fit asks of trajectories: which of them a record leaves out; how fast errors of a state
// grow along them, and how long steps of integration are beside the fastest rate: where they can't
// be integrated, and where they aren't integrated well.
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "base/stop.hpp"
#include "sepcal/detail/states/state_steps.hpp"
#include "states/start_deviations.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double largest_eigenvalue(const MatrixXd& A) {
  if (!A.allFinite()) return infinity;
  return A.eigenvalues().cwiseAbs().maxCoeff();
}

/// Takes every step of all trajectories: visit(row, begins, x, step).
template <class Visit>
void follow(const TrajectoryPlan& plan, const StateSteps& along, const Record& record,
            const VectorXd& xi, const Visit& visit) {
  VectorXd x = VectorXd::Zero(static_cast<Index>(plan.integrated().size()));
  for (const Segment& segment : record.segments()) {
    for (std::size_t row = segment.first; row + 1 < segment.last; ++row) {
      base::heed_stop();
      const int trajectory = plan.trajectory_at(row, row == segment.first);
      if (trajectory >= 0) x = states::start_of(plan, trajectory, xi);
      const StateSteps::Step step = along.advance(row, x);
      visit(row, trajectory >= 0, x, step);
      x = step.x;
    }
  }
}

}  // namespace

std::vector<std::string> StateBlockModel::idle_parameters(const Record& record) const {
  const std::vector<std::size_t>& starts = plan().starts();
  std::vector<std::string> idle;
  for (std::size_t t = 0; t < starts.size(); ++t) {
    const auto holds = [row = starts[t]](const Segment& segment) {
      return segment.first <= row && row < segment.last;
    };
    if (std::ranges::any_of(record.segments(), holds)) continue;
    for (const int i : plan().integrated()) {
      const std::string& state = plan().model().states[static_cast<std::size_t>(i)].name;
      idle.push_back(plan().start_name(state, static_cast<int>(t)));
    }
  }
  return idle;
}

double StateBlockModel::growth(const Record& record, const VectorXd& xi) const {
  const std::unique_ptr<StateSteps> along = steps(record, xi);
  const auto n_x = static_cast<Index>(plan().integrated().size());
  double most = 1.0;
  MatrixXd grown = MatrixXd::Identity(n_x, n_x);
  follow(
      plan(), *along, record, xi,
      [&](std::size_t /*row*/, bool begins, const VectorXd& /*x*/, const StateSteps::Step& step) {
        if (begins) {
          most = std::max(most, largest_eigenvalue(grown));
          grown.setIdentity();
        }
        grown = step.Phi * grown;
      });
  return std::max(most, largest_eigenvalue(grown));
}

double StateBlockModel::coarseness(const Record& record, const VectorXd& xi) const {
  if (plan().discrete() || plan().integrated().empty()) return 0.0;
  constexpr std::size_t rows_to_try = 200;
  const std::size_t stride = std::max<std::size_t>(1, record.rows() / rows_to_try);
  const std::unique_ptr<StateSteps> along = steps(record, xi);
  const std::span<const double> time = record.column("time");
  double most = 0.0;
  std::size_t taken = 0;
  follow(
      plan(), *along, record, xi,
      [&](std::size_t row, bool /*begins*/, const VectorXd& x, const StateSteps::Step& /*step*/) {
        if (taken++ % stride != 0 || !x.allFinite()) return;
        const MatrixXd F = along->rate_slopes(row, x);
        if (!F.allFinite()) return;
        const double dt = (time[row + 1] - time[row]) / plan().options().substeps;
        most = std::max(most, dt * largest_eigenvalue(F));
      });
  return most;
}

}  // namespace sepcal
