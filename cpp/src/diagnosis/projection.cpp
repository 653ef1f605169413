// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/projection.hpp"

#include <algorithm>

#include "numerics/decompositions.hpp"

namespace sepcal::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Columns of unit length; those that are zero stay so.
VectorXd scale_to_unit(MatrixXd& columns) {
  VectorXd norms = columns.colwise().norm().transpose();
  for (Index k = 0; k < norms.size(); ++k) {
    if (!(norms[k] > 0)) norms[k] = 1.0;
    columns.col(k) /= norms[k];
  }
  return norms;
}

MatrixXd thin_q(const Eigen::HouseholderQR<MatrixXd>& qr, Index columns) {
  return qr.householderQ() * MatrixXd::Identity(qr.rows(), columns);
}

}  // namespace

MatrixXd orthonormal_basis(const MatrixXd& columns) {
  MatrixXd scaled = columns;
  scale_to_unit(scaled);
  Eigen::ColPivHouseholderQR<MatrixXd> qr(scaled);
  qr.setThreshold(1e-10);
  return qr.householderQ() * MatrixXd::Identity(columns.rows(), qr.rank());
}

MatrixXd join(const MatrixXd& left, const MatrixXd& right) {
  MatrixXd both(left.rows(), left.cols() + right.cols());
  both << left, right;
  return both;
}

MatrixXd remove_span(const MatrixXd& basis, const MatrixXd& columns) {
  MatrixXd left = columns;
  for (int twice = 0; twice < 2; ++twice) left -= basis * (basis.transpose() * left);
  return left;
}

Projection project(const MatrixXd& tangent_basis, const MatrixXd& G, const MatrixXd& whole,
                   double least_visibility) {
  constexpr double deficient = 1e-10;  // singular value of columns of unit length
  Projection projection;
  const Index q = G.cols();
  if (G.rows() < q) return projection;
  MatrixXd scaled = whole;
  const VectorXd norms = scale_to_unit(scaled);
  const Eigen::HouseholderQR<MatrixXd> factor(scaled);
  const MatrixXd R = factor.matrixQR().topRows(q).triangularView<Eigen::Upper>();
  if (!(Eigen::JacobiSVD<MatrixXd>(R).singularValues()[q - 1] > deficient)) return projection;
  const MatrixXd inverse = R.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(q, q));
  const MatrixXd to_coefficients = norms.cwiseInverse().asDiagonal() * inverse;
  const Eigen::HouseholderQR<MatrixXd> qr(remove_span(tangent_basis, G * to_coefficients));
  const MatrixXd relative = qr.matrixQR().topRows(q).triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<MatrixXd> svd(relative, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const VectorXd& sines = svd.singularValues();
  projection.visibility = std::min(1.0, sines[q - 1]);
  const Index visible = (sines.array() >= least_visibility).count();
  projection.basis = thin_q(qr, q) * svd.matrixU().leftCols(visible);
  projection.to_effect = to_coefficients * svd.matrixV().leftCols(visible) *
                         sines.head(visible).cwiseInverse().asDiagonal();
  return projection;
}

}  // namespace sepcal::diagnosis
