// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/normal_equations.hpp"

#include "numerics/decompositions.hpp"

namespace sepcal::numerics {

ExplainedSquares explained_squares(const Eigen::MatrixXd& square, const Eigen::VectorXd& product,
                                   const Eigen::VectorXd& lengths) {
  constexpr double open = 1e-10;  // of the largest eigenvalue
  ExplainedSquares explained;
  if (square.size() == 0) return explained;
  const Eigen::VectorXd scale =
      lengths.unaryExpr([](double length) { return length > 0.0 ? 1.0 / length : 0.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * square *
                                                             scale.asDiagonal());
  const Eigen::VectorXd along = eigen.eigenvectors().transpose() * (scale.asDiagonal() * product);
  const double least = open * eigen.eigenvalues().maxCoeff();
  for (Eigen::Index i = 0; i < along.size(); ++i) {
    if (!(eigen.eigenvalues()[i] > least)) continue;
    explained.square += along[i] * along[i] / eigen.eigenvalues()[i];
    ++explained.directions;
  }
  return explained;
}

}  // namespace sepcal::numerics
