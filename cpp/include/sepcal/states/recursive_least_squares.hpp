// SPDX-License-Identifier: BSD-3-Clause
// Recursive least squares, S 4.9 to 4.14, sample by sample from a start. Two forms of one
// recursion; the third, InformationRoot, needs no start and keeps twice the digits.
#pragma once

#include <utility>

#include "sepcal/detail/states/measured.hpp"
#include "sepcal/detail/states/product.hpp"
#include "sepcal/detail/states/square_root_form.hpp"
#include "sepcal/detail/states/triangle.hpp"

namespace sepcal {

/// S 4.13 and 4.12: R(k+1) = R(k) + H'W^-1 H is kept, and a matrix of N x N is factored a sample.
template <int N, class Scalar = double>
class InformationRecursion {
 public:
  using Vector = Eigen::Vector<Scalar, N>;
  using Matrix = Eigen::Matrix<Scalar, N, N>;

  /// p(0) and R(0) = the inverse of its covariance, positive definite.
  InformationRecursion(Vector p, Matrix R) : p_(std::move(p)), R_(std::move(R)) {}

  /// y = H p + e (M rows, NaN in y where missing), W = E(ee') (M x M, positive definite). False
  /// where a number or a matrix is unfit: nothing is changed.
  template <int M>
  bool absorb(const Eigen::Matrix<Scalar, M, N>& H, const Eigen::Vector<Scalar, M>& y,
              const Eigen::Matrix<Scalar, M, M>& W) {
    const states::Measured<M, N, Scalar> seen(y, states::product(H, p_), H, W);
    const Eigen::Matrix<Scalar, M, M> U_W = states::upper_root(seen.R);
    const Eigen::Matrix<Scalar, M, N> whitened = states::solve_transposed(U_W, seen.H);
    const Matrix R = R_ + states::product(whitened.transpose(), whitened);
    const Matrix U = states::upper_root(R);
    const Vector gradient =
        states::product(whitened.transpose(), states::solve_transposed(U_W, seen.e));
    const Vector p = p_ + states::solve_upper(U, states::solve_transposed(U, gradient));
    const bool positive = (U_W.diagonal().array() > 0).all() && (U.diagonal().array() > 0).all();
    if (!positive || !p.allFinite()) return false;
    p_ = p;
    R_ = R;
    return true;
  }

  const Vector& solution() const { return p_; }
  /// R^-1, S 4.13.
  Matrix covariance() const {
    const Matrix U = states::upper_root(R_);
    return states::solve_upper(U,
                               states::solve_transposed(U, Matrix::Identity(p_.size(), p_.size())));
  }

 private:
  Vector p_;
  Matrix R_;
};

/// S 4.14 and 4.12: R^-1 is kept, as its root: subtracted as it stands, what little is left of a
/// wide start would be rounding. S 4.14 prints a W^-1 too many:
/// R^-1(k+1) = (I - R^-1 H'(H R^-1 H' + W)^-1 H) R^-1, W = W(k+1).
template <int N, class Scalar = double>
class CovarianceRecursion {
 public:
  using Vector = Eigen::Vector<Scalar, N>;
  using Matrix = Eigen::Matrix<Scalar, N, N>;

  /// p(0) and R^-1(0), its covariance, positive semidefinite.
  CovarianceRecursion(Vector p, const Matrix& P) : p_(std::move(p)), form_(P) {}

  /// As InformationRecursion::absorb(); W may be singular as long as H R^-1 H' + W is not.
  template <int M>
  bool absorb(const Eigen::Matrix<Scalar, M, N>& H, const Eigen::Vector<Scalar, M>& y,
              const Eigen::Matrix<Scalar, M, M>& W) {
    const states::Measured<M, N, Scalar> seen(y, states::product(H, p_), H, W);
    SquareRootForm<N, Scalar> next = form_;
    const Gain<N, M, Scalar> gain = next.update(seen.H, seen.R);
    const Vector p = p_ + states::product(gain.Kbar, states::solve_transposed(gain.S, seen.e));
    if (!(gain.S.diagonal().array() > 0).all() || !p.allFinite()) return false;
    p_ = p;
    form_ = std::move(next);
    return true;
  }

  const Vector& solution() const { return p_; }
  Matrix covariance() const { return form_.covariance(); }

 private:
  Vector p_;
  SquareRootForm<N, Scalar> form_;
};

}  // namespace sepcal
