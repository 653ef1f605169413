// SPDX-License-Identifier: BSD-3-Clause
// A filter's covariance multiplied out, updated by Joseph's form, S 3.18: symmetric and positive
// for any gain, and cheaper than reflections for few states. It loses P where P(0) and R are
// fifteen orders of magnitude apart; SquareRootForm, with the same interface, loses half as many
// digits.
#pragma once

#include <utility>

#include "sepcal/detail/states/square_root_form.hpp"

namespace sepcal {

template <int NX, class Scalar = double>
class JosephForm {
 public:
  using Matrix = Eigen::Matrix<Scalar, NX, NX>;

  /// From P (n_x x n_x, positive semidefinite).
  explicit JosephForm(Matrix P) : P_(std::move(P)) {}

  /// From U, U'U = P, or from R, R'R = P^-1.
  static JosephForm of_covariance_root(const Matrix& U) {
    return JosephForm(states::product(U.transpose(), U));
  }
  static JosephForm of_information_root(const Matrix& R) {
    return of_covariance_root(states::inverse_root(R));
  }

  const Matrix& covariance() const { return P_; }
  Matrix root() const { return states::upper_root(P_); }

  /// S 2.8, 2.13, 3.11: P <- Phi P Phi' + Gamma Q_d Gamma'.
  template <int NW>
  void predict(const Matrix& Phi, const Eigen::Matrix<Scalar, NX, NW>& Gamma,
               const Eigen::Matrix<Scalar, NW, NW>& Q_d) {
    const Eigen::Matrix<Scalar, NW, NX> noise =  // all NaN where Q_d is no covariance
        states::product(states::upper_root(Q_d), Gamma.transpose());
    P_ = symmetric(states::product(Phi, P_, Phi.transpose()) +
                   states::product(noise.transpose(), noise));
  }

  /// S 2.11, and 3.18 in place of 2.10: P <- (I - K C) P (I - K C)' + K R K'.
  template <int NZ>
  Gain<NX, NZ, Scalar> update(const Eigen::Matrix<Scalar, NZ, NX>& C,
                              const Eigen::Matrix<Scalar, NZ, NZ>& R) {
    const Eigen::Matrix<Scalar, NZ, NZ> U_R = states::upper_root(R);
    const Eigen::Matrix<Scalar, NZ, NX> CP = states::product(C, P_);
    const Eigen::Matrix<Scalar, NZ, NZ> S = states::upper_root(
        (states::product(CP, C.transpose()) + states::product(U_R.transpose(), U_R)).eval());
    const Eigen::Matrix<Scalar, NZ, NX> whitened = states::solve_transposed(S, CP);  // Kbar'
    const Eigen::Matrix<Scalar, NX, NZ> K = states::solve_upper(S, whitened).transpose();
    const Matrix rest = Matrix::Identity(P_.rows(), P_.cols()) - states::product(K, C);
    const Eigen::Matrix<Scalar, NZ, NX> noise = states::product(U_R, K.transpose());
    P_ = symmetric(states::product(rest, P_, rest.transpose()) +
                   states::product(noise.transpose(), noise));
    return {S, whitened.transpose()};
  }

 private:
  static Matrix symmetric(const Matrix& P) { return Scalar(0.5) * (P + P.transpose()); }

  Matrix P_;
};

}  // namespace sepcal
