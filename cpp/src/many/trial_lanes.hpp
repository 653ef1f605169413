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

#include "base/aligned_doubles.hpp"
#include "estimation/problem.hpp"
#include "many/trial_design.hpp"
#include "model/lane_kit.hpp"

namespace sepcal::many {

/// Where a trial ended, n free parameters.
struct TrialEnd {
  std::size_t trial = 0;
  Eigen::VectorXd x;        // n
  Eigen::VectorXd squares;  // n_z, sums of squared residuals
  Eigen::MatrixXd R;        // (n + 1) x (n + 1): factor of [A | D | r], each output over its noise
  Eigen::VectorXd lengths;  // n, of the columns of [A | D], not over their noise
  double z_square = 0.0;    // sum of z^2
};

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
  /// Of one lane; vectors of all lanes stand by themselves.
  struct Lane {
    std::size_t trial = 0;
    bool busy = false;
    bool begun = false;     // factors_ are this trial's
    bool ending = false;    // the step to come is the last
    bool free_step = true;  // the last step was neither damped nor clipped
    double damping = 0.0;
    double size_before = 0.0;  // of the last step, in standard errors
    double z_square = 0.0;
    int passes = 0;
    int clipped = 0;  // steps in a row
  };

  bool load(std::size_t lane, std::size_t trial, const Eigen::MatrixXd& starts);
  void factor();
  bool judge(std::size_t lane);
  bool is_downhill(std::size_t lane) const;
  bool is_sound(std::size_t lane) const;
  bool take_noise(std::size_t lane);
  void whiten();
  void measure(std::size_t lane);
  const double* damp();
  void solve(const double* factor);
  bool step(std::size_t lane);
  const TrialEnd& end_of(std::size_t lane);

  std::size_t place(std::size_t row, std::size_t column) const {
    return (row * columns_ + column) * width_;
  }

  const TrialDesign& design_;
  const lanes::LaneKit& kit_;
  bool (*absorb_)(double* T, double* rows, std::size_t m, std::size_t stride);
  std::size_t width_;
  std::size_t n_1_;
  std::size_t n_;
  std::size_t n_z_;
  std::size_t columns_;  // n + 1
  std::size_t panel_;    // rows at a time
  Eigen::VectorXd lower_;
  Eigen::VectorXd upper_;
  Eigen::VectorXd given_noise_;  // n_z, or empty

  std::vector<Lane> lanes_;
  base::AlignedDoubles z_;        // n_z N
  base::AlignedDoubles x_;        // n, the last point that was accepted
  base::AlignedDoubles tried_;    // n
  base::AlignedDoubles delta_;    // n, the step from x_
  base::AlignedDoubles factors_;  // n_z of (n + 1)^2, at x_
  base::AlignedDoubles next_;     // the same at tried_
  base::AlignedDoubles squares_;  // n_z, at x_
  base::AlignedDoubles weights_;  // n_z, one over the noise
  base::AlignedDoubles whole_;    // (n + 1)^2, of all outputs over their noise
  base::AlignedDoubles damped_;
  base::AlignedDoubles rows_;  // scratch
  TrialEnd end_;
};

}  // namespace sepcal::many
