// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/detail/compiled_models.hpp"

#include "numerics/decompositions.hpp"

namespace sepcal {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// xi2 of C = (I + S) (I + E) C_lambda, S symmetric without a diagonal, E skew: C / C_lambda - I =
/// S + E + S E, its last part taken from the round before.
Vec<double, 6> factorise(const Matrix3d& C) {
  constexpr int rounds = 100;
  Vec<double, 6> xi2 = Vec<double, 6>::Zero();
  for (int round = 0; round < rounds; ++round) {
    const Matrix3d now = Magnetometer::soft_iron_and_misalignment<double>(xi2);
    const Eigen::Vector3d scale = C.diagonal().cwiseQuotient(now.diagonal());
    const Matrix3d off = C * scale.cwiseInverse().asDiagonal() - now;
    const Matrix3d even = 0.5 * (off + off.transpose());
    const Matrix3d odd = 0.5 * (off - off.transpose());
    const Vec<double, 6> step(odd(2, 1), odd(0, 2), odd(1, 0), even(0, 1), even(0, 2), even(1, 2));
    xi2 += step;
    if (!(step.norm() > 1e-12)) break;
  }
  return xi2;
}

}  // namespace

MatrixXd Magnetometer::guess(const MatrixXd& u, const MatrixXd& z) {
  MatrixXd columns(u.rows(), 4);
  columns << u, VectorXd::Ones(u.rows());
  const MatrixXd solution = Eigen::ColPivHouseholderQR<MatrixXd>(columns).solve(z);
  const Vec<double, 6> xi2 = factorise(solution.topRows<3>().transpose());
  return xi2.allFinite() ? MatrixXd(xi2) : MatrixXd(6, 0);
}

}  // namespace sepcal
