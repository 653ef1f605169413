// SPDX-License-Identifier: BSD-3-Clause
// Weighted least squares as square-root information: the triangle T of all rows [H z] so far, each
// whitened by its W^-1/2, T = [R q; 0 rho]. The fixed-size sibling of TriangularFactor, for flight.
#pragma once

#include <utility>

#include "sepcal/detail/states/measured.hpp"
#include "sepcal/detail/states/product.hpp"
#include "sepcal/detail/states/triangle.hpp"

namespace sepcal {

/// Of N parameters p in z = H p + e, S 4.9.
template <int N, class Scalar = double>
class InformationRoot {
 public:
  using Triangle = Eigen::Matrix<Scalar, states::together(N, 1), states::together(N, 1)>;
  using Vector = Eigen::Vector<Scalar, N>;
  using Matrix = Eigen::Matrix<Scalar, N, N>;

  /// Nothing is known; a size that is Eigen::Dynamic comes with a matrix of zeros, below.
  InformationRoot() = default;

  /// From another's matrix(), or a TriangularFactor's of N + 1 columns: a batch goes on as a
  /// stream, without an inversion.
  explicit InformationRoot(Triangle T) : T_(std::move(T)) {}

  /// Absorbs z = H p + e (M rows, NaN in z where missing) with W = E(ee') (M x M, positive
  /// definite: a covariance, its inverse weighs). False where W or a number is unfit: nothing is
  /// absorbed.
  template <int M>
  bool absorb(const Eigen::Matrix<Scalar, M, N>& H, const Eigen::Vector<Scalar, M>& z,
              const Eigen::Matrix<Scalar, M, M>& W) {
    const states::Measured<M, N, Scalar> seen(z, Eigen::Vector<Scalar, M>::Zero(z.size()), H, W);
    const Eigen::Matrix<Scalar, M, M> U_W = states::upper_root(seen.R);
    if (!(U_W.diagonal().array() > 0).all()) return false;
    Eigen::Matrix<Scalar, M, states::together(N, 1)> rows(H.rows(), H.cols() + 1);
    rows << seen.H, seen.e;
    rows = states::solve_transposed(U_W, rows);
    Triangle T = T_;
    states::absorb_rows(T, rows);
    if (!T.allFinite()) return false;
    T_ = T;
    count_ += seen.count;
    return true;
  }

  /// T = [R q; 0 rho], upper triangular, T'T = [H z]'W^-1 [H z].
  const Triangle& matrix() const { return T_; }
  /// R'R = sum of H'W^-1 H, S 4.11.
  Matrix root() const { return T_.template topLeftCorner<N, N>(size(), size()); }
  /// Values that were absorbed here, M of S 4.7's s^2.
  int count() const { return count_; }

  /// Whether the rows determine every parameter.
  bool determined() const {
    const Matrix R = root();
    for (Eigen::Index k = 0; k < size(); ++k) {
      if (states::is_nil(R, k)) return false;
    }
    return true;
  }

  /// p (N), S 4.6 and 4.10. What the rows leave open is zero: see determined().
  Vector solution() const {
    if constexpr (N == 0) {
      return Vector();
    } else {
      return states::solve_upper(root(), T_.template topRightCorner<N, 1>(size(), 1));
    }
  }

  /// E(dp dp') = (H'W^-1 H)^-1, N x N, S 4.7: where W is the errors' covariance. Where it is known
  /// up to a factor, times s^2 = 2 cost() / (count() - N).
  Matrix covariance() const {
    const Matrix inverse = states::solve_upper(root(), Matrix::Identity(size(), size()));
    return states::product(inverse, inverse.transpose());
  }

  /// V(p) at the solution, S 4.5: half the weighted sum of squares that is left.
  Scalar cost() const { return Scalar(0.5) * T_(size(), size()) * T_(size(), size()); }

 private:
  Eigen::Index size() const { return T_.cols() - 1; }

  Triangle T_ = states::zeros<Triangle>();
  int count_ = 0;
};

}  // namespace sepcal
