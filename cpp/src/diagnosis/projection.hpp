// SPDX-License-Identifier: BSD-3-Clause
// What a candidate adds beyond the tangent of the fit: G_perp = (I - QQ')G, from one orthogonal
// basis of the tangent.
#pragma once

#include <Eigen/Core>

#include "numerics/decompositions.hpp"

namespace sepcal::diagnosis {

/// An orthonormal basis of some columns, of their numerical rank.
Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& columns);

/// Columns of two matrices, side by side.
Eigen::MatrixXd join(const Eigen::MatrixXd& left, const Eigen::MatrixXd& right);

/// What of `columns` is orthogonal to a basis.
Eigen::MatrixXd remove_span(const Eigen::MatrixXd& basis, const Eigen::MatrixXd& columns);

/// A candidate's columns beside a tangent, in the directions that can be seen there.
struct Projection {
  Eigen::MatrixXd basis;      // orthonormal, of the visible part of G_perp: count x visible
  Eigen::MatrixXd to_effect;  // q x visible: the coefficients of G behind those of the basis
  double visibility = 0.0;    // smallest singular value of G_perp relative to `whole`, at most 1

  Eigen::Index visible() const { return basis.cols(); }
};

/// `tangent_basis` as orthonormal_basis() gives it. `whole`: the columns that G_perp is measured
/// against, G itself or the part of it that varies. A direction is visible from `least_visibility`
/// on; none is where `whole` is deficient.
Projection project(const Eigen::MatrixXd& tangent_basis, const Eigen::MatrixXd& G,
                   const Eigen::MatrixXd& whole, double least_visibility);

}  // namespace sepcal::diagnosis
