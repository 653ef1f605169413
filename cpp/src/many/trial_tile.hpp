// SPDX-License-Identifier: BSD-3-Clause
// The arithmetic of trials side by side: each lane's factor of [A | D | r] at a point of its own,
// and the step that it gives. What a lane tries, takes and ends at, TrialLanes decides.
#pragma once

#include <Eigen/Core>
#include <cstddef>
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

class TrialTile {
 public:
  /// Both must outlive this.
  TrialTile(const estimation::Problem& problem, const TrialDesign& design);

  std::size_t width() const { return width_; }
  std::size_t parameters() const { return n_; }

  /// A trial's z into a lane. False where it is not finite.
  bool load(std::size_t lane, std::size_t trial);

  /// The point that a lane tries next, the last that it took, and the step from there.
  double& tried(std::size_t k, std::size_t lane) { return tried_[k * width_ + lane]; }
  double x(std::size_t k, std::size_t lane) const { return x_[k * width_ + lane]; }
  double step(std::size_t k, std::size_t lane) const { return delta_[k * width_ + lane]; }

  /// One factor of [A | D | r] an output, of every lane, at the points tried.
  void factor();

  /// Of those factors: no number that isn't finite, no column whose square underflows or overflows.
  bool is_sound(std::size_t lane) const;

  /// Whether the cost there is no higher than at the point taken, by rounding.
  bool is_downhill(std::size_t lane) const;

  /// The point tried becomes the one taken, R its own (Eq. 25) or the one that was given. False
  /// where there is next to no residual.
  bool take(std::size_t lane);

  /// The factor of all outputs, each over its noise, of every lane at the point taken.
  void whiten();

  /// Entry (i, c) of it, columns [A | D | r].
  double whole(std::size_t i, std::size_t c, std::size_t lane) const {
    return whole_[place(i, c) + lane];
  }

  /// Gauss-Newton's steps, damped by `damping` (one a lane) of columns of unit length.
  void solve(const std::vector<double>& damping);

  /// What a lane ends with, at the point tried, a last step from the one taken.
  void describe(std::size_t lane, TrialEnd& end) const;

 private:
  bool take_noise(std::size_t lane);
  const double* damp(const std::vector<double>& damping);
  /// Returns whether every lane was safe.
  bool absorb(double* T, double* rows, std::size_t m) const {
    const lanes::Panel panel = lanes::stack_panel(kit_, columns_, T, rows, m);
    return lanes::absorb_panels(kit_, {&panel, 1}, m);
  }

  std::size_t place(std::size_t row, std::size_t column) const {
    return (row * columns_ + column) * width_;
  }

  const TrialDesign& design_;
  std::size_t width_;
  std::size_t n_1_;
  std::size_t n_;
  std::size_t n_z_;
  std::size_t columns_;  // n + 1
  const lanes::LaneKit& kit_;
  std::size_t panel_;                 // rows at a time
  std::vector<lanes::Panel> panels_;  // n_z, of a pass
  Eigen::VectorXd given_noise_;       // n_z, or empty

  std::vector<double> z_squares_;  // one a lane; what follows has an entry for each lane
  base::AlignedDoubles z_;         // n_z N
  base::AlignedDoubles x_;         // n
  base::AlignedDoubles tried_;     // n
  base::AlignedDoubles delta_;     // n
  base::AlignedDoubles factors_;   // n_z of (n + 1)^2, at x_
  base::AlignedDoubles next_;      // the same at tried_
  base::AlignedDoubles squares_;   // n_z, sums of r^2 at x_
  base::AlignedDoubles weights_;   // n_z, one over the noise
  base::AlignedDoubles whole_;     // (n + 1)^2
  base::AlignedDoubles damped_;    // (n + 1)^2
  base::AlignedDoubles rows_;      // scratch
};

}  // namespace sepcal::many
