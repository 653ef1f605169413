// SPDX-License-Identifier: BSD-3-Clause
#include "objective.hpp"

#include <limits>

namespace sepcal {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double JointObjective::square(const VectorXd& x) {
  const Index n_1 = sweep_.tables().n_1();
  const VectorXd sums = sweep_.squared_residuals(x.head(n_1), x.tail(x.size() - n_1));
  return sums.dot(weights_.cwiseAbs2()) + (prior_ ? prior_->square(x) : 0.0);
}

bool JointObjective::linearise(const VectorXd& x, VectorXd& residual, MatrixXd& jacobian) {
  const Index n = parameters();
  const Index n_1 = sweep_.tables().n_1();
  factors_ = sweep_.tangent_factors(x.head(n_1), x.tail(n - n_1));
  TriangularFactor factor = combine(factors_, weights_);
  if (prior_) prior_->join(factor, x);
  if (!factor.all_finite()) return false;
  residual = factor.matrix().col(n);
  jacobian = -factor.matrix().leftCols(n);
  return true;
}

const TriangularFactor& ProjectedObjective::linear_factor(const VectorXd& xi2) {
  if (at_.size() != xi2.size() || at_ != xi2 || factor_.columns() == 0) {
    factor_ = combine(sweep_.linear_factors(xi2), weights_);
    at_ = xi2;
  }
  return factor_;
}

VectorXd ProjectedObjective::linear_estimate(const VectorXd& xi2) {
  const Index n_1 = sweep_.tables().n_1();
  const MatrixXd& T = linear_factor(xi2).matrix();
  return solve_triangular(T.topLeftCorner(n_1, n_1), T.col(n_1).head(n_1)).x;
}

double ProjectedObjective::square(const VectorXd& xi2) {
  const TriangularFactor& factor = linear_factor(xi2);
  return factor.all_finite() ? remaining_square(factor) : std::numeric_limits<double>::quiet_NaN();
}

bool ProjectedObjective::linearise(const VectorXd& xi2, VectorXd& residual, MatrixXd& jacobian) {
  const Index n_1 = sweep_.tables().n_1();
  const Index n_2 = parameters();
  if (!linear_factor(xi2).all_finite()) return false;
  const VectorXd xi1 = linear_estimate(xi2);
  const TriangularFactor factor = combine(sweep_.tangent_factors(xi1, xi2), weights_);
  if (!factor.all_finite()) return false;
  const MatrixXd& T = factor.matrix();

  // Rows orthogonal to A's columns: n_2 + 1 below A's, and those that a singular A does not reach.
  const MatrixXd unseen =
      solve_triangular(T.topLeftCorner(n_1, n_1), VectorXd::Zero(n_1)).unseen.transpose();
  residual = VectorXd::Zero(residuals());
  jacobian = MatrixXd::Zero(residuals(), n_2);
  residual.head(n_2 + 1) = T.col(n_1 + n_2).tail(n_2 + 1);
  jacobian.topRows(n_2) = -T.block(n_1, n_1, n_2, n_2);
  residual.segment(n_2 + 1, unseen.rows()) = unseen * T.col(n_1 + n_2).head(n_1);
  jacobian.middleRows(n_2 + 1, unseen.rows()) = -unseen * T.block(0, n_1, n_1, n_2);
  return true;
}

}  // namespace sepcal
