// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/models/pitot_static.hpp"
#include "sepcal/detail/compiled_models.hpp"

#include "numerics/decompositions.hpp"

namespace sepcal {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd PitotStatic::guess(const MatrixXd& u, const MatrixXd& z) {
  constexpr double indistinct = 1e-8;  // a column that the others explain
  const auto ground = u.leftCols<3>();
  MatrixXd columns(u.rows(), 5);  // 2 W, a, b - |W|^2 of |v|^2
  columns << ground, z.cwiseAbs2(), VectorXd::Ones(u.rows());
  const VectorXd lengths = columns.colwise().norm().cwiseMax(1e-300).transpose();
  columns.array().rowwise() /= lengths.transpose().array();
  Eigen::ColPivHouseholderQR<MatrixXd> factor(columns);
  factor.setThreshold(indistinct);
  // What a level flight doesn't tell of the vertical wind is zero.
  const VectorXd solution = factor.solve(ground.rowwise().squaredNorm()).cwiseQuotient(lengths);
  return 0.5 * solution.head<3>();
}

}  // namespace sepcal
