// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/projection.hpp"

#include <algorithm>

#include "numerics/decompositions.hpp"
#include "numerics/tall_products.hpp"
#include "sepcal/detail/triangular_factor.hpp"

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

MatrixXd inverse_of(const MatrixXd& R) {
  return R.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(R.rows(), R.cols()));
}

MatrixXd factor_of(const MatrixXd& columns) {
  TriangularFactor factor(static_cast<int>(columns.cols()));
  for (Index row = 0; row < columns.rows(); row += panel_rows) {
    MatrixXd panel = columns.middleRows(row, std::min(panel_rows, columns.rows() - row));
    factor.absorb(panel);
  }
  return factor.matrix();
}

/// columns * weights in their place, of which there are no more.
void multiply_in_place(MatrixXd& columns, const MatrixXd& weights) {
  for (Index row = 0; row < columns.rows(); row += panel_rows) {
    auto panel = columns.middleRows(row, std::min(panel_rows, columns.rows() - row));
    panel.leftCols(weights.cols()) = (panel * weights).eval();
  }
  columns.conservativeResize(Eigen::NoChange, weights.cols());
}

}  // namespace

MatrixXd orthonormal_weights(MatrixXd R) {
  if (R.size() == 0) return R;  // Eigen pivots no fewer than one column
  const VectorXd norms = scale_to_unit(R);
  Eigen::ColPivHouseholderQR<MatrixXd> qr(R);
  qr.setThreshold(1e-10);
  const Index rank = qr.rank();
  MatrixXd weights = MatrixXd::Zero(R.cols(), rank);
  weights.topRows(rank) = inverse_of(qr.matrixQR().topLeftCorner(rank, rank));
  return norms.cwiseInverse().asDiagonal() * (qr.colsPermutation() * weights);
}

MatrixXd orthonormal_basis(MatrixXd columns) {
  multiply_in_place(columns, orthonormal_weights(factor_of(columns)));
  multiply_in_place(columns, inverse_of(factor_of(columns)));  // what rounding left
  return columns;
}

MatrixXd remove_span(const MatrixXd& basis, const MatrixXd& columns) {
  MatrixXd left = columns;
  for (int twice = 0; twice < 2; ++twice) left -= basis * (basis.transpose() * left);
  return left;
}

void orthonormalise(LinearisedFit& fit) {
  const MatrixXd R = factor_of(fit.tangent);
  fit.weights = orthonormal_weights(R);
  multiply_in_place(fit.tangent, fit.weights);
  const MatrixXd left = inverse_of(factor_of(fit.tangent));  // by rounding
  multiply_in_place(fit.tangent, left);
  fit.weights *= left;
  fit.coordinates = (R * fit.weights).transpose() * R;
}

TangentBasis::TangentBasis(const LinearisedFit& fit) : fit_(&fit) {
  const Index rank = fit.tangent.cols();
  weights_ = fit.weights.size() > 0 ? MatrixXd(MatrixXd::Identity(rank, rank))
                                    : orthonormal_weights(factor_of(fit.tangent));
}

Columns TangentBasis::columns() const {
  if (fit_->weights.size() > 0) return view(fit_->tangent);
  return {rank(), [&J = fit_->tangent, C = weights_](Index first, Eigen::Ref<MatrixXd> rows) {
            rows.noalias() = J.middleRows(first, rows.rows()) * C;
          }};
}

VectorXd TangentBasis::remove_from(VectorXd column) const {
  const MatrixXd& J = fit_->tangent;
  for (int twice = 0; twice < 2; ++twice) {
    column -= J * (weights_ * (weights_.transpose() * (J.transpose() * column)));
  }
  return column;
}

namespace {

/// C of J C by the tangent's columns or the basis in their place.
MatrixXd explained_on(const TangentBasis& tangent, const Columns& G) {
  const LinearisedFit& fit = tangent.fit();
  MatrixXd products = MatrixXd::Zero(fit.tangent.cols(), G.cols());
  for_each_panel(fit.layout, [&](Index first, Index rows) {
    numerics::add_transposed_product(fit.tangent.middleRows(first, rows), G.rows(first, rows),
                                     products);
  });
  return tangent.weights() * (tangent.weights().transpose() * products);
}

MatrixXd in_parameters(const TangentBasis& tangent, const MatrixXd& C) {
  const MatrixXd& weights = tangent.fit().weights;
  return weights.size() > 0 ? MatrixXd(weights * C) : C;
}

/// (G - J C) W.
Columns subtract_tangent(const TangentBasis& tangent, const Columns& G, const MatrixXd& C,
                         const MatrixXd& W) {
  return {W.cols(), [&J = tangent.fit().tangent, G, W, explained = MatrixXd(-C * W)](
                        Index first, Eigen::Ref<MatrixXd> rows) {
            rows.setZero();
            numerics::add_product(G.rows(first, rows.rows()), W, rows);
            numerics::add_product(J.middleRows(first, rows.rows()), explained, rows);
          }};
}

MatrixXd factor_of(const RowLayout& layout, const Columns& columns) {
  TriangularFactor factor(static_cast<int>(columns.cols()));
  for_each_panel(layout, [&](Index first, Index rows) {
    MatrixXd panel = columns.rows(first, rows);
    factor.absorb(panel);
  });
  return factor.matrix();
}

}  // namespace

MatrixXd explained_by(const TangentBasis& tangent, const Columns& G) {
  return in_parameters(tangent, explained_on(tangent, G));
}

Columns remove_tangent(const TangentBasis& tangent, const Columns& G) {
  return subtract_tangent(tangent, G, explained_on(tangent, G),
                          MatrixXd::Identity(G.cols(), G.cols()));
}

Columns span_beyond(const TangentBasis& tangent, const Columns& G) {
  const MatrixXd C = explained_on(tangent, G);
  const MatrixXd whole = MatrixXd::Identity(G.cols(), G.cols());
  const MatrixXd R = factor_of(tangent.fit().layout, subtract_tangent(tangent, G, C, whole));
  return subtract_tangent(tangent, G, C, orthonormal_weights(R));
}

BeyondTangent measure_beyond(const TangentBasis& tangent, const Columns& G, const Columns& whole) {
  constexpr double deficient = 1e-10;  // singular value of columns of unit length
  const RowLayout& layout = tangent.fit().layout;
  BeyondTangent beyond;
  const Index q = G.cols();
  if (layout.count() < q) return beyond;
  MatrixXd R = factor_of(layout, whole);
  const VectorXd norms = scale_to_unit(R);
  if (!(Eigen::JacobiSVD<MatrixXd>(R).singularValues()[q - 1] > deficient)) return beyond;
  beyond.to_coefficients = norms.cwiseInverse().asDiagonal() * inverse_of(R);
  beyond.shares = explained_on(tangent, G);
  beyond.absorbed = in_parameters(tangent, beyond.shares);
  beyond.columns = subtract_tangent(tangent, G, beyond.shares, beyond.to_coefficients);
  return beyond;
}

SeenDirections find_seen_directions(const MatrixXd& R, double least_visibility) {
  if (R.size() == 0) return {};
  const Eigen::JacobiSVD<MatrixXd> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const VectorXd& sines = svd.singularValues();
  const Index visible = (sines.array() >= least_visibility).count();
  return {std::min(1.0, sines[sines.size() - 1]),
          svd.matrixV().leftCols(visible) * sines.head(visible).cwiseInverse().asDiagonal()};
}

Projection project(const TangentBasis& tangent, const Columns& G, const Columns& whole,
                   double least_visibility) {
  const BeyondTangent beyond = measure_beyond(tangent, G, whole);
  const auto [visibility, directions] =
      find_seen_directions(factor_of(tangent.fit().layout, beyond.columns), least_visibility);
  Projection projection{.absorbed = beyond.absorbed, .visibility = visibility};
  if (beyond.columns.cols() == 0) return projection;
  projection.to_effect = beyond.to_coefficients * directions;
  projection.basis = subtract_tangent(tangent, G, beyond.shares, projection.to_effect);
  return projection;
}

}  // namespace sepcal::diagnosis
