// SPDX-License-Identifier: BSD-3-Clause
// Stage two of several trials side by side (Sun & Gebre-Egziabher, Step 5): Gauss-Newton steps of
// (xi1, xi2), damped where one leads uphill, each lane by itself. R follows the parameters from
// step to step (Eq. 25), which ends where alternating to the end does (Eq. 26). A lane that is done
// takes the next trial.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

#include "estimation/problem.hpp"
#include "many/trial_design.hpp"
#include "many/trial_tile.hpp"

namespace sepcal::many {

class TrialLanes {
 public:
  /// Whether the model has lanes for trials, and no more columns than their factors take.
  static bool take(const BlockModel& model);

  /// Both must outlive this.
  TrialLanes(const estimation::Problem& problem, const TrialDesign& design);

  /// Fits the trials from `first` to before `last` from `starts` (n x K). Those that converge
  /// within the bounds are given to `done`, in no order; the others' numbers are returned, in none
  /// either.
  std::vector<std::size_t> fit(std::size_t first, std::size_t last, const Eigen::MatrixXd& starts,
                               const std::function<void(const TrialEnd&)>& done);

 private:
  struct Lane {
    std::size_t trial = 0;
    bool busy = false;
    bool begun = false;        // a point was taken
    bool ending = false;       // the step to come is the last
    bool free_step = true;     // the last step was neither damped nor clipped
    double size_before = 0.0;  // of the last step, in standard errors
    int passes = 0;
    int clipped = 0;  // steps in a row
  };

  bool load(std::size_t lane, std::size_t trial, const Eigen::MatrixXd& starts);
  bool judge(std::size_t lane);
  void measure(std::size_t lane);
  bool step(std::size_t lane);

  TrialTile tile_;
  numerics::Box box_;
  std::vector<Lane> lanes_;
  std::vector<double> damping_;  // one a lane
  TrialEnd end_;
};

}  // namespace sepcal::many
