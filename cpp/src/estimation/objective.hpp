// SPDX-License-Identifier: BSD-3-Clause
// The two compressed least-squares problems of stage two: `joint` over (xi1, xi2) and `projected`
// over xi2 with xi1 = xi1hat(xi2) solved inside. However long the record, each has n_1 + n_2 + 1
// residuals [Q'r; what remains] whose sum of squares is the whitened record's, and the Jacobian
// -[R; 0].
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "estimation/plausibility.hpp"
#include "model/loss.hpp"
#include "model/sweep.hpp"
#include "numerics/box.hpp"

namespace sepcal::estimation {

class Objective {
 public:
  /// `weights` (n_z): 1 / noise standard deviation of each output. `priors`: over (xi1, xi2), each
  /// adds its square and its rows.
  Objective(const model::Sweep& sweep, Eigen::VectorXd weights, std::vector<Prior> priors = {})
      : sweep_(sweep), weights_(std::move(weights)), priors_(std::move(priors)) {}
  Objective(const Objective&) = delete;
  Objective& operator=(const Objective&) = delete;
  virtual ~Objective() = default;

  virtual int parameters() const = 0;
  int residuals() const { return sweep_.tables().n_1() + sweep_.tables().n_2() + 1; }

  /// Sum of whitened squares at x; not finite where the model is not.
  virtual double square(const Eigen::VectorXd& x) = 0;

  /// Residual (residuals()) and Jacobian (residuals() x parameters()) at x; false where the model
  /// is not finite.
  virtual bool linearise(const Eigen::VectorXd& x, Eigen::VectorXd& residual,
                         Eigen::MatrixXd& jacobian) = 0;

 protected:
  const model::Sweep& sweep_;
  Eigen::VectorXd weights_;
  std::vector<Prior> priors_;
};

/// x = (xi1, xi2), Eq. 20's left-hand side. With a loss, the sum of rho instead of squares, and
/// rows weighted by sqrt(w) behind the factor: its gradient is exact, and so is the cost, by one
/// more row of what rho exceeds the weighted squares by.
class JointObjective final : public Objective {
 public:
  JointObjective(const model::Sweep& sweep, Eigen::VectorXd weights, std::vector<Prior> priors = {},
                 std::optional<model::RobustLoss> loss = {})
      : Objective(sweep, std::move(weights), std::move(priors)), loss_(loss) {}
  int parameters() const override { return residuals() - 1; }
  double square(const Eigen::VectorXd& x) override;
  bool linearise(const Eigen::VectorXd& x, Eigen::VectorXd& residual,
                 Eigen::MatrixXd& jacobian) override;

  /// One factor of [A | D | r] an output, not whitened, without priors, of the point linearised
  /// last.
  const std::vector<TriangularFactor>& factors() const { return factors_; }

 private:
  std::optional<model::RobustLoss> loss_;
  std::vector<TriangularFactor> factors_;
};

/// x = xi2, Eq. 20's right-hand side. Kaufman's Jacobian: the D-D block of the factor of [A D r] at
/// xi1hat(xi2) is the projected Jacobian's R factor. Golub and Pereyra's has n_1 rows more, R_AA^-T
/// G with G_j = sum_k (dA_k/dxi2_j)' r_k, in which the residual is zero: the derivative of the
/// projector acting on r (SIAM J. Numer. Anal. 10 (1973), Eq. 4.8). A singular A loses only what it
/// does not see: the rows U_perp' R_AD join, and the pseudo-inverse stands for the inverse.
class ProjectedObjective final : public Objective {
 public:
  ProjectedObjective(const model::Sweep& sweep, Eigen::VectorXd weights,
                     std::vector<Prior> priors = {},
                     ProjectedJacobian jacobian = ProjectedJacobian::kaufman)
      : Objective(sweep, std::move(weights), std::move(priors)), jacobian_(jacobian) {}
  int parameters() const override { return sweep_.tables().n_2(); }
  double square(const Eigen::VectorXd& x) override;
  bool linearise(const Eigen::VectorXd& x, Eigen::VectorXd& residual,
                 Eigen::MatrixXd& jacobian) override;

  /// xi1hat(xi2), Eq. 27 (n_1).
  Eigen::VectorXd linear_estimate(const Eigen::VectorXd& xi2);

  /// square() where xi1 is the best within its bounds.
  double square_within(const Eigen::VectorXd& xi2, const numerics::Box& linear);

 private:
  /// The whitened factor of [A | z - b]; kept for the point asked for last.
  const TriangularFactor& linear_factor(const Eigen::VectorXd& xi2);

  ProjectedJacobian jacobian_;
  Eigen::VectorXd at_;
  TriangularFactor factor_{0};
};

}  // namespace sepcal::estimation
