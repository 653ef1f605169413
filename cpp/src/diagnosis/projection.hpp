// SPDX-License-Identifier: BSD-3-Clause
// What a candidate adds beyond the tangent of the fit: G_perp = (I - QQ')G, from one orthogonal
// basis of the tangent.
#pragma once

#include <Eigen/Core>

#include "diagnosis/columns.hpp"

namespace sepcal::diagnosis {

/// An orthonormal basis of some columns, of their numerical rank.
Eigen::MatrixXd orthonormal_basis(Eigen::MatrixXd columns);

/// What of `columns` is orthogonal to a basis.
Eigen::MatrixXd remove_span(const Eigen::MatrixXd& basis, const Eigen::MatrixXd& columns);

/// Columns whose factor is R (TriangularFactor's) times this are orthonormal, in their numerical
/// rank: columns x rank.
Eigen::MatrixXd orthonormal_weights(Eigen::MatrixXd R);

/// An orthonormal basis takes the tangent's place, whose columns are not needed any more.
void orthonormalise(LinearisedFit& fit);

/// The tangent with what makes an orthonormal basis of it, Q = tangent * weights. Q is kept where
/// it has the tangent's place alone.
class TangentBasis {
 public:
  TangentBasis() = default;
  /// `fit` must outlive it.
  explicit TangentBasis(const LinearisedFit& fit);

  const LinearisedFit& fit() const { return *fit_; }
  Eigen::Index rank() const { return weights_.cols(); }
  const Eigen::MatrixXd& weights() const { return weights_; }
  Columns columns() const;

  /// What of a column (count()) is orthogonal to the tangent.
  Eigen::VectorXd remove_from(Eigen::VectorXd column) const;

 private:
  const LinearisedFit* fit_ = nullptr;
  Eigen::MatrixXd weights_ = {};
};

/// C of J C, what the tangent J explains of G: parameters x G's columns.
Eigen::MatrixXd explained_by(const TangentBasis& tangent, const Columns& G);

/// What of G is orthogonal to the tangent, whose fit must outlive it.
Columns remove_tangent(const TangentBasis& tangent, const Columns& G);

/// An orthonormal basis of what of G is orthogonal to the tangent, of its numerical rank. The
/// tangent's fit must outlive it.
Columns span_beyond(const TangentBasis& tangent, const Columns& G);

/// A candidate's columns beside a tangent, in the directions that can be seen there.
struct Projection {
  Columns basis = {};              // orthonormal, of the visible part of G_perp
  Eigen::MatrixXd to_effect = {};  // q x visible: the coefficients of G behind those of the basis
  Eigen::MatrixXd absorbed = {};   // parameters x q: least squares of G on the tangent
  double visibility = 0.0;  // smallest singular value of G_perp relative to `whole`, at most 1

  Eigen::Index visible() const { return basis.cols(); }
};

/// G_perp in units of `whole`, where these have full rank: then there are q columns.
struct BeyondTangent {
  Columns columns = {};                  // G_perp * to_coefficients
  Eigen::MatrixXd to_coefficients = {};  // makes `whole` orthonormal
  Eigen::MatrixXd shares = {};           // of the tangent's columns in G
  Eigen::MatrixXd absorbed = {};         // as a projection's
};
BeyondTangent measure_beyond(const TangentBasis& tangent, const Columns& G, const Columns& whole);

/// The directions of those columns, whose triangular factor is R, that can be seen: the basis is
/// the columns times `directions`.
struct SeenDirections {
  double visibility = 0.0;
  Eigen::MatrixXd directions = {};  // q x visible
};
SeenDirections find_seen_directions(const Eigen::MatrixXd& R, double least_visibility);

/// `whole`: the columns that G_perp is measured against, G itself or the part of it that varies. A
/// direction is visible from `least_visibility` on; none is where `whole` is deficient. The
/// tangent's fit must outlive the result.
Projection project(const TangentBasis& tangent, const Columns& G, const Columns& whole,
                   double least_visibility);

}  // namespace sepcal::diagnosis
