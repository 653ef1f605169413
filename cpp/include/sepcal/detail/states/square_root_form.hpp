// SPDX-License-Identifier: BSD-3-Clause
// A filter's covariance as its triangular root, P = U'U, propagated by orthogonal reflections
// (array form): P is positive whatever the scales, and holds twice the digits of a covariance that
// is multiplied out. Kailath, Sayed & Hassibi, Linear Estimation, Ch. 12.
#pragma once

#include "sepcal/detail/states/product.hpp"
#include "sepcal/detail/states/triangle.hpp"

namespace sepcal {

/// What an update hands to the state: Lambda = S'S, and the gain K = Kbar S^-T of S 2.11.
template <int NX, int NZ, class Scalar = double>
struct Gain {
  Eigen::Matrix<Scalar, NZ, NZ> S;     // upper triangular root of the innovation's covariance
  Eigen::Matrix<Scalar, NX, NZ> Kbar;  // x(k+1|k+1) = x(k+1|k) + Kbar w, w = S^-T e
};

template <int NX, class Scalar = double>
class SquareRootForm {
 public:
  using Matrix = Eigen::Matrix<Scalar, NX, NX>;

  /// From P (n_x x n_x, positive semidefinite; else everything that follows is NaN).
  explicit SquareRootForm(const Matrix& P) : root_(states::upper_root(P)) {}

  /// From U, U'U = P, upper triangular; or from R, R'R = P^-1, regular.
  static SquareRootForm of_covariance_root(const Matrix& U) {
    SquareRootForm form;
    form.root_ = U;
    return form;
  }
  static SquareRootForm of_information_root(const Matrix& R) {
    return of_covariance_root(states::inverse_root(R));
  }

  Matrix covariance() const { return states::product(root_.transpose(), root_); }
  const Matrix& root() const { return root_; }

  /// S 2.8, 2.13, 3.11: P <- Phi P Phi' + Gamma Q_d Gamma'.
  template <int NW>
  void predict(const Matrix& Phi, const Eigen::Matrix<Scalar, NX, NW>& Gamma,
               const Eigen::Matrix<Scalar, NW, NW>& Q_d) {
    Eigen::Matrix<Scalar, states::together(NX, NW), NX> rows(Phi.rows() + Q_d.rows(), Phi.cols());
    rows << states::product(root_, Phi.transpose()),
        states::product(states::upper_root(Q_d), Gamma.transpose());
    root_.setZero();
    states::absorb_rows(root_, rows);
  }

  /// S 2.10, 2.11: [U_R 0; U C' U] = Q [S Kbar'; 0 U+].
  template <int NZ>
  Gain<NX, NZ, Scalar> update(const Eigen::Matrix<Scalar, NZ, NX>& C,
                              const Eigen::Matrix<Scalar, NZ, NZ>& R) {
    constexpr int n = states::together(NZ, NX);
    using Array = Eigen::Matrix<Scalar, n, n>;
    const Eigen::Index n_z = C.rows();
    const Eigen::Index n_x = C.cols();
    Array T = Array::Zero(n_z + n_x, n_z + n_x);
    T.template topLeftCorner<NZ, NZ>(n_z, n_z) = states::upper_root(R);
    Eigen::Matrix<Scalar, NX, n> rows(n_x, n_z + n_x);
    rows << states::product(root_, C.transpose()), root_;
    states::absorb_rows(T, rows);
    root_ = T.template bottomRightCorner<NX, NX>(n_x, n_x);
    return {T.template topLeftCorner<NZ, NZ>(n_z, n_z),
            T.template topRightCorner<NZ, NX>(n_z, n_x).transpose()};
  }

 private:
  SquareRootForm() = default;

  Matrix root_;
};

}  // namespace sepcal
