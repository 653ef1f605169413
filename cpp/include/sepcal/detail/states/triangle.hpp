// SPDX-License-Identifier: BSD-3-Clause
// Upper-triangular matrices, U'U = P: Householder reflections, Cholesky factors of
// what may be singular, substitution. The dynamic sibling is sepcal/triangular_factor.hpp; this one
// needs no memory, throws nothing and is meant for a few dozen columns. Golub & Van Loan, Sec. 4.2
// and 5.2.
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/states/product.hpp"

namespace sepcal::states {

template <class Scalar>
constexpr Scalar rounding = std::numeric_limits<Scalar>::epsilon();

/// Triangularises [T; rows]: T'T grows by rows' rows, T's diagonal is not negative, `rows` (any
/// number of them) is scratch that is left destroyed. A column of which not more than `nil` times
/// its length is left when its turn comes counts as zero: it depends on those before it. A NaN
/// stays one. The largest row is reflected onto first: rows of very different size, as those of
/// states that die away without noise, keep their digits each (M. J. D. Powell & J. K. Reid, On
/// applying Householder transformations to linear least squares problems, 1969).
template <class Scalar, int N, int M>
void absorb_rows(Eigen::Matrix<Scalar, N, N>& T, Eigen::Matrix<Scalar, M, N>& rows,
                 std::type_identity_t<Scalar> nil = 0) {
  const Eigen::Index n = T.cols();
  Eigen::Vector<Scalar, N> least = Eigen::Vector<Scalar, N>::Zero(n);
  if (nil > 0) {
    for (Eigen::Index k = 0; k < n; ++k)
      least[k] = nil * std::hypot(T.col(k).norm(), rows.col(k).norm());
  }
  for (Eigen::Index k = 0; k < n; ++k) {
    // The reflector I - tau v v' with v = [1; x / v0] maps [T(k,k); x] onto a multiple of e_1.
    auto x = rows.col(k);
    const Scalar tail = x.norm();
    const Scalar length = std::hypot(T(k, k), tail);
    if (tail == Scalar(0) || length <= least[k]) continue;
    Eigen::Index largest = 0;
    if (x.cwiseAbs().maxCoeff(&largest) > std::abs(T(k, k))) {
      for (Eigen::Index j = k; j < n; ++j) std::swap(T(k, j), rows(largest, j));
    }
    const Scalar reflected = T(k, k) > 0 ? -length : length;
    const Scalar v0 = T(k, k) - reflected;
    const Scalar tau = -v0 / reflected;
    x /= v0;
    T(k, k) = reflected;
    for (Eigen::Index j = k + 1; j < n; ++j) {
      const Scalar shadow = tau * (T(k, j) + x.dot(rows.col(j)));
      T(k, j) -= shadow;
      rows.col(j) -= shadow * x;
    }
  }
  for (Eigen::Index k = 0; k < n; ++k) {
    if (T(k, k) < 0) T.row(k) *= Scalar(-1);
  }
}

/// U, upper triangular, with U'U = P (N x N, symmetric, of which the upper half is read). P may be
/// singular: a pivot that is zero within rounding makes a row of zeros. A P that is not positive
/// semidefinite, or not finite, makes U all NaN, which every later status tells.
template <class Scalar, int N>
Eigen::Matrix<Scalar, N, N> upper_root(const Eigen::Matrix<Scalar, N, N>& P) {
  using Matrix = Eigen::Matrix<Scalar, N, N>;
  const Eigen::Index n = P.cols();
  const Scalar unit = static_cast<Scalar>(n) * rounding<Scalar>;
  const Scalar slack = 100 * unit;  // how far below zero rounding takes a pivot
  Matrix U = Matrix::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Scalar pivot = P(k, k) - U.col(k).head(k).squaredNorm();
    const bool nil = pivot <= unit * P(k, k);
    bool sound = pivot >= -slack * P(k, k) && std::isfinite(pivot);
    if (!nil) U(k, k) = std::sqrt(pivot);
    for (Eigen::Index j = k + 1; j < n; ++j) {
      const Scalar rest = P(k, j) - U.col(k).head(k).dot(U.col(j).head(k));
      sound = sound && (!nil || rest * rest <= slack * P(k, k) * P(j, j));
      if (!nil) U(k, j) = rest / U(k, k);
    }
    if (!sound) return Matrix::Constant(n, n, std::numeric_limits<Scalar>::quiet_NaN());
  }
  return U;
}

/// Whether U's column k adds nothing to those before it: its pivot is rounding beside its length.
template <class Scalar, int N>
bool is_nil(const Eigen::Matrix<Scalar, N, N>& U, Eigen::Index k) {
  const Scalar unit = static_cast<Scalar>(U.cols()) * rounding<Scalar>;
  return U(k, k) == Scalar(0) || std::abs(U(k, k)) <= unit * U.col(k).head(k + 1).norm();
}

/// Whether every column of U adds to those before it, and is finite.
template <class Scalar, int N>
bool is_regular(const Eigen::Matrix<Scalar, N, N>& U) {
  bool regular = U.allFinite();
  for (Eigen::Index k = 0; k < U.cols(); ++k) regular = regular && !is_nil(U, k);
  return regular;
}

/// X with U'X = B (N x M) for an upper-triangular U; rows of X that U does not determine are zero.
template <class Scalar, int N, class Right>
Eigen::Matrix<Scalar, N, Right::ColsAtCompileTime> solve_transposed(
    const Eigen::Matrix<Scalar, N, N>& U, const Eigen::MatrixBase<Right>& B) {
  Eigen::Matrix<Scalar, N, Right::ColsAtCompileTime> X = B;
  for (Eigen::Index k = 0; k < U.cols(); ++k) {
    for (Eigen::Index i = 0; i < k; ++i) X.row(k) -= U(i, k) * X.row(i);
    if (is_nil(U, k)) {
      X.row(k).setZero();
    } else {
      X.row(k) /= U(k, k);
    }
  }
  return X;
}

/// X with U X = B (N x M) for an upper-triangular U; rows of X that U does not determine are zero.
template <class Scalar, int N, class Right>
Eigen::Matrix<Scalar, N, Right::ColsAtCompileTime> solve_upper(const Eigen::Matrix<Scalar, N, N>& U,
                                                               const Eigen::MatrixBase<Right>& B) {
  Eigen::Matrix<Scalar, N, Right::ColsAtCompileTime> X = B;
  for (Eigen::Index k = U.cols() - 1; k >= 0; --k) {
    for (Eigen::Index j = k + 1; j < U.cols(); ++j) X.row(k) -= U(k, j) * X.row(j);
    if (is_nil(U, k)) {
      X.row(k).setZero();
    } else {
      X.row(k) /= U(k, k);
    }
  }
  return X;
}

/// X with A X = B (N x M) by reflections; all NaN where A (N x N) is singular. Rows are brought to
/// one size first, so that units of states are no singularity.
template <class Scalar, int N, int M>
Eigen::Matrix<Scalar, N, M> solve_square(const Eigen::Matrix<Scalar, N, N>& A,
                                         const Eigen::Matrix<Scalar, N, M>& B) {
  constexpr int both = together(N, M);
  using Array = Eigen::Matrix<Scalar, both, both>;
  const Eigen::Index n = A.cols();
  const Eigen::Index m = B.cols();
  Array T = Array::Zero(n + m, n + m);
  const Eigen::Vector<Scalar, N> size = A.cwiseAbs().rowwise().maxCoeff();
  Eigen::Matrix<Scalar, N, both> rows(n, n + m);
  rows << A, B;
  rows = size.cwiseInverse().asDiagonal() * rows;
  absorb_rows(T, rows);
  const Eigen::Matrix<Scalar, N, N> U = T.template topLeftCorner<N, N>(n, n);
  if (!is_regular(U)) {
    return Eigen::Matrix<Scalar, N, M>::Constant(n, m, std::numeric_limits<Scalar>::quiet_NaN());
  }
  return solve_upper(U, T.template topRightCorner<N, M>(n, m));
}

/// V, upper triangular, with V'V = (U'U)^-1: a covariance's root from an information's, and back.
/// All NaN where U is singular.
template <class Scalar, int N>
Eigen::Matrix<Scalar, N, N> inverse_root(const Eigen::Matrix<Scalar, N, N>& U) {
  using Matrix = Eigen::Matrix<Scalar, N, N>;
  const Eigen::Index n = U.cols();
  if (!is_regular(U)) return Matrix::Constant(n, n, std::numeric_limits<Scalar>::quiet_NaN());
  Matrix rows = solve_transposed(U, Matrix::Identity(n, n));
  Matrix V = Matrix::Zero(n, n);
  absorb_rows(V, rows);
  return V;
}

}  // namespace sepcal::states
