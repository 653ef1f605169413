// SPDX-License-Identifier: BSD-3-Clause
// The parameters and R in turn, the steps of stage two (Eqs. 24-26): a descent by Ceres, the last
// digits that a comparison of costs can't see, the noise of what remains.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "estimation/attempts.hpp"
#include "estimation/minimise.hpp"
#include "estimation/refine.hpp"
#include "estimation/stages.hpp"
#include "model/sweep.hpp"

namespace sepcal::estimation {

class Alternation {
 public:
  /// Works on `result`, whose x, noise and method are where it begins; all must outlive it.
  Alternation(const Problem& problem, const model::Sweep& sweep, double first_radius,
              StageTwo& result);

  /// Takes the noise of the residuals at the start: by the loss's own scale, which outliers don't
  /// raise, or what stage one says, with its floor.
  void begin_noise();

  /// Takes the parameters' lengths from the start. Where the record leaves a combination of them
  /// open there, nothing in it would keep them from running away: if asked to hold them, a loose
  /// prior does, and the fit is joint. Linear parameters then begin at its mean, as open ones may
  /// be anywhere, unless the start is near.
  void look_around(const Attempt& attempt);

  /// Minimises J over the parameters at the present R, from result.x.
  void descend();

  /// Takes x to the last digit at the present R; false, with x as it was, where no minimum is near.
  bool refine();

  /// The same in a few passes, and only to what lies lower: false for all but a near minimum.
  bool refine_downhill();

  /// R-hat of the present residuals with its floor; the largest relative change (Eq. 26).
  double update_noise();

  /// Whether the record leaves a combination open at the solution.
  bool ends_open() const;

  /// Whether a loose prior holds what is open.
  bool holds() const;

  /// Drops the prior where the solution turns out to determine everything; whether it did.
  bool release_what_is_determined();

 private:
  Eigen::VectorXd xi1() const { return result_.x.head(sweep_.tables().n_1()); }
  Eigen::VectorXd xi2() const { return result_.x.tail(sweep_.tables().n_2()); }
  Eigen::VectorXd weights() const { return result_.noise.cwiseInverse(); }
  double rows() const { return static_cast<double>(sweep_.measurements().rows()); }

  void take(const Refinement& refinement, const JointObjective& objective);

  /// One factor of all outputs, with what is known beforehand.
  TriangularFactor whiten(const std::vector<TriangularFactor>& factors) const;
  /// Each output's noise by the loss's own scale.
  Eigen::VectorXd scales(const model::RobustLoss& loss) const;
  /// Keeps a noise-free output from sending J to minus infinity.
  Eigen::VectorXd raise_to_floor(Eigen::VectorXd noise) const;
  /// False where a linear parameter left its bounds, which the inner problem does not know.
  bool descend_projected();
  /// The inner problem of a projected fit does not know the bounds of linear parameters.
  void fall_back_to_joint(Eigen::Index bounded);

  const Problem& problem_;
  const model::Sweep& sweep_;
  numerics::Box box_;
  Eigen::VectorXd scale_;  // plausible length of each parameter, where it was linearised last
  DescentOptions descent_;
  std::vector<Prior> priors_;  // what is known, and what holds open combinations for a while
  std::optional<model::RobustLoss> loss_;
  StageTwo& result_;
};

}  // namespace sepcal::estimation
