// SPDX-License-Identifier: BSD-3-Clause
// J of Eq. 6 over one record, and the steps to its minimum, each from a point to a point: a descent
// by Ceres, the last digits that a comparison of costs can't see, the noise of what remains.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "estimation/minimise.hpp"
#include "estimation/refine.hpp"
#include "estimation/stage_two.hpp"
#include "model/loss.hpp"
#include "model/sweep.hpp"

namespace sepcal::estimation {

class Likelihood {
 public:
  /// Both must outlive it.
  Likelihood(const Problem& problem, const model::Sweep& sweep);

  /// Stage one's end within the bounds. Its noise is the given one; else that of the residuals
  /// there, by the loss's own scale, which outliers don't raise, or what stage one says, with its
  /// floor (Eq. 24).
  StageTwo begin(const StageOne& start, SecondStage method) const;

  /// Where the record leaves a combination of parameters open, nothing in it would keep them from
  /// running away: a loose prior does, and the fit is joint. Linear parameters then begin at its
  /// mean, as open ones may be anywhere, unless the start is `near`.
  StageTwo hold_open(StageTwo at, bool near) const;

  /// Minimises J over the parameters at the point's noise (Eq. 20). Projected becomes joint where a
  /// linear parameter meets a bound, which the inner problem does not know.
  StageTwo descend(StageTwo at, double first_radius) const;

  /// The same by SLSQP, jointly: along bounds and flat valleys, where descend() stands still.
  StageTwo slide(StageTwo at) const;

  /// x to the last digit, or until steps are as short as a `share` of the first; not `refined`,
  /// with x as it was, where no minimum is near.
  StageTwo refine(StageTwo at, double share = 0.0) const;

  /// The same in a few passes, and only to what lies lower: nothing for all but a near minimum.
  std::optional<StageTwo> refine_downhill(const StageTwo& at) const;

  /// R-hat of the residuals at the point, as standard deviations with their floor (n_z, Eq. 25).
  Eigen::VectorXd noise_at(const StageTwo& at) const;

  /// Whether the record leaves a combination open at the point.
  bool leaves_open(const StageTwo& at) const;

  /// J of Eq. 6 at the point, without its constant, with the prior.
  double cost(const StageTwo& at) const;

  const Problem& problem() const { return problem_; }

 private:
  Eigen::Index n_1() const { return sweep_.tables().n_1(); }
  Eigen::Index n_2() const { return sweep_.tables().n_2(); }
  double rows() const { return static_cast<double>(sweep_.measurements().rows()); }
  DescentOptions descent(double first_radius) const;

  /// The fit's, and what holds open combinations for a while.
  std::vector<Prior> priors(const StageTwo& at) const;
  /// One factor of all outputs, with the prior.
  TriangularFactor whiten(const StageTwo& at) const;
  StageTwo take(StageTwo at, const Refinement& refinement, const JointObjective& objective) const;
  JointObjective joint_objective(const StageTwo& at) const;
  StageTwo fall_back_to_joint(StageTwo at, Eigen::Index bounded) const;

  /// Each output's noise by the loss's own scale.
  Eigen::VectorXd scales(const StageTwo& at, const model::RobustLoss& loss) const;
  /// Keeps a noise-free output from sending J to minus infinity.
  Eigen::VectorXd raise_to_floor(Eigen::VectorXd noise) const;

  const Problem& problem_;
  const model::Sweep& sweep_;
  numerics::Box box_;
  std::optional<model::RobustLoss> loss_;
};

/// Sum of squared residuals by output, off factors of [A | D | r] (n_z).
Eigen::VectorXd squares(const std::vector<TriangularFactor>& factors);

}  // namespace sepcal::estimation
