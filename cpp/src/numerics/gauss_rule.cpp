// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/gauss_rule.hpp"

#include "numerics/decompositions.hpp"

namespace sepcal::numerics {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

GaussRule gauss_rule(const VectorXd& x, const VectorXd& w, Index count) {
  MatrixXd Q(x.size(), count);  // orthonormal polynomials at x, times the roots of the weights
  VectorXd diagonal(count);
  VectorXd beside(count - 1);
  Q.col(0) = (w / w.sum()).cwiseSqrt();
  for (Index k = 0; k < count; ++k) {
    VectorXd next = x.cwiseProduct(Q.col(k));
    diagonal[k] = Q.col(k).dot(next);
    if (k + 1 == count) break;
    const auto before = Q.leftCols(k + 1);
    for (int twice = 0; twice < 2; ++twice) next -= before * (before.transpose() * next);
    beside[k] = next.norm();
    Q.col(k + 1) = next / beside[k];
  }
  Eigen::SelfAdjointEigenSolver<MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, beside);
  return {solver.eigenvalues(), w.sum() * solver.eigenvectors().row(0).transpose().cwiseAbs2()};
}

}  // namespace sepcal::numerics
