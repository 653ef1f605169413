// SPDX-License-Identifier: BSD-3-Clause
#include "states/start_deviations.hpp"

namespace sepcal::states {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double wide = 10.0;  // times the largest value on the way

VectorXd largest_on_the_way(const StateSteps& steps, const Segment& segment, VectorXd x) {
  VectorXd largest = x.cwiseAbs();
  for (std::size_t row = segment.first; row + 1 < segment.last; ++row) {
    x = steps.next(row, x);
    if (!x.allFinite()) break;
    largest = largest.cwiseMax(x.cwiseAbs());
  }
  return largest;
}

}  // namespace

VectorXd start_of(const TrajectoryPlan& plan, int trajectory, const VectorXd& xi) {
  const std::vector<int>& states = plan.integrated();
  VectorXd x(static_cast<Index>(states.size()));
  for (Index i = 0; i < x.size(); ++i) {
    x[i] = xi[plan.column_of_start(states[static_cast<std::size_t>(i)], trajectory)];
  }
  return x;
}

VectorXd start_deviations(const StateSteps& steps, const Segment& segment, const VectorXd& x,
                          const std::vector<std::string>& names,
                          const std::map<std::string, double>& given) {
  const bool all_given = given.size() == names.size();
  VectorXd deviations = all_given ? x : largest_on_the_way(steps, segment, x);
  for (Index i = 0; i < deviations.size(); ++i) {
    const auto known = given.find(names[static_cast<std::size_t>(i)]);
    if (known != given.end()) {
      deviations[i] = known->second;
    } else {
      deviations[i] = deviations[i] > 0 ? wide * deviations[i] : wide;
    }
  }
  return deviations;
}

}  // namespace sepcal::states
