// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/objective.hpp"

#include <limits>

#include "numerics/bounded_least_squares.hpp"

namespace sepcal::estimation {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double JointObjective::square(const VectorXd& x) {
  const Index n_1 = sweep_.tables().n_1();
  const VectorXd xi1 = x.head(n_1);
  const VectorXd xi2 = x.tail(x.size() - n_1);
  double sum = 0.0;
  if (loss_) {
    sum = sweep_.losses(xi1, xi2, *loss_, weights_).sum();
  } else {
    sum = sweep_.squared_residuals(xi1, xi2).dot(weights_.cwiseAbs2());
  }
  for (const Prior& prior : priors_) sum += prior.square(x);
  return sum;
}

bool JointObjective::linearise(const VectorXd& x, VectorXd& residual, MatrixXd& jacobian) {
  const Index n = parameters();
  const Index n_1 = sweep_.tables().n_1();
  const VectorXd xi1 = x.head(n_1);
  const VectorXd xi2 = x.tail(n - n_1);
  factors_ = loss_ ? sweep_.forgiving_factors(xi1, xi2, *loss_, weights_)
                   : sweep_.tangent_factors(xi1, xi2);
  TriangularFactor factor = combine(factors_, weights_);
  for (const Prior& prior : priors_) prior.join(factor, x);
  if (!factor.all_finite()) return false;
  residual = factor.matrix().col(n);
  jacobian = -factor.matrix().leftCols(n);
  return true;
}

const TriangularFactor& ProjectedObjective::linear_factor(const VectorXd& xi2) {
  if (at_.size() != xi2.size() || at_ != xi2 || factor_.columns() == 0) {
    factor_ = combine(sweep_.linear_factors(xi2), weights_);
    const Index n_1 = sweep_.tables().n_1();
    for (const Prior& prior : priors_) prior.head(n_1).join(factor_, VectorXd::Zero(n_1));
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
  if (!factor.all_finite()) return std::numeric_limits<double>::quiet_NaN();
  double sum = remaining_square(factor);
  for (const Prior& prior : priors_) sum += prior.tail(xi2.size()).square(xi2);
  return sum;
}

double ProjectedObjective::square_within(const VectorXd& xi2, const numerics::Box& linear) {
  const VectorXd free = linear_estimate(xi2);
  const VectorXd within = linear.clip(free);
  if (within == free) return square(xi2);
  const Index n_1 = free.size();
  const MatrixXd R = linear_factor(xi2).matrix().topLeftCorner(n_1, n_1);
  const numerics::BoundedSolution step = numerics::solve_bounded(
      R, R * (free - within), {linear.lower - within, linear.upper - within});
  return square(xi2) + (R * (within + step.x - free)).squaredNorm();
}

bool ProjectedObjective::linearise(const VectorXd& xi2, VectorXd& residual, MatrixXd& jacobian) {
  const Index n_1 = sweep_.tables().n_1();
  const Index n_2 = parameters();
  if (!linear_factor(xi2).all_finite()) return false;
  VectorXd x(n_1 + n_2);
  x << linear_estimate(xi2), xi2;
  TriangularFactor factor = combine(sweep_.tangent_factors(x.head(n_1), xi2), weights_);
  for (const Prior& prior : priors_) prior.join(factor, x);
  if (!factor.all_finite()) return false;
  const MatrixXd& T = factor.matrix();

  // Rows orthogonal to A's columns: n_2 + 1 below A's, and those that a singular A does not reach.
  const MatrixXd R_AA = T.topLeftCorner(n_1, n_1);
  const MatrixXd unseen = solve_triangular(R_AA, VectorXd::Zero(n_1)).unseen;
  const MatrixXd outside = unseen * unseen.transpose();
  residual.resize(residuals());
  jacobian = MatrixXd::Zero(residuals(), n_2);
  residual << T.col(n_1 + n_2).tail(n_2 + 1), outside * T.col(n_1 + n_2).head(n_1);
  jacobian.topRows(n_2) = -T.block(n_1, n_1, n_2, n_2);
  jacobian.bottomRows(n_1) = -outside * T.block(0, n_1, n_1, n_2);
  if (jacobian_ == ProjectedJacobian::golub_pereyra) {
    const std::vector<MatrixXd> by_output = sweep_.slope_products(x.head(n_1), xi2);
    MatrixXd G = MatrixXd::Zero(n_1, n_2);
    for (Index j = 0; j < weights_.size(); ++j) {
      G += weights_[j] * weights_[j] * by_output[static_cast<std::size_t>(j)];
    }
    jacobian.bottomRows(n_1) -= generalised_inverse(R_AA).transpose() * G;
  }
  return jacobian.allFinite();
}

}  // namespace sepcal::estimation
