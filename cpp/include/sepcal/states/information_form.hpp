// SPDX-License-Identifier: BSD-3-Clause
// A filter's covariance as the triangular root of its inverse, P^-1 = R'R: the square-root
// information filter behind the interface of the other forms. A batch's triangular factor goes on
// as it is, with no inversion. G. J. Bierman, Factorization Methods for Discrete Sequential
// Estimation (1977), Ch. V and VI.
#pragma once

#include <concepts>
#include <limits>

#include "sepcal/detail/states/product.hpp"
#include "sepcal/detail/states/square_root_form.hpp"
#include "sepcal/detail/states/triangle.hpp"

namespace sepcal {

template <int NX, class Scalar = double>
class InformationForm {
 public:
  using Matrix = Eigen::Matrix<Scalar, NX, NX>;

  /// From P (n_x x n_x, positive definite; else everything that follows is NaN).
  explicit InformationForm(const Matrix& P) : root_(states::inverse_root(states::upper_root(P))) {}

  /// From U, U'U = P, upper triangular and regular.
  static InformationForm of_covariance_root(const Matrix& U) {
    return of_information_root(states::inverse_root(U));
  }
  /// From R, R'R = P^-1, upper triangular and regular: the leading part of a batch's factor.
  static InformationForm of_information_root(const Matrix& R) {
    InformationForm form;
    form.root_ = R;
    return form;
  }

  Matrix root() const {
    const Even even(root_);
    if (!states::is_regular(even.root))
      return Matrix::Constant(root_.rows(), root_.cols(), no_number);
    Matrix rows = even.solve_transposed(Matrix(Matrix::Identity(root_.rows(), root_.cols())));
    Matrix U = Matrix::Zero(root_.rows(), root_.cols());
    states::absorb_rows(U, rows);
    return U;
  }
  Matrix covariance() const {
    const Matrix U = root();
    return states::product(U.transpose(), U);
  }
  const Matrix& information_root() const { return root_; }

  /// S 2.8, 2.13, 3.11, as information (Bierman, Ch. VI): with w_d = U_Q' omega of unit covariance,
  /// [I 0; -R Phi^-1 Gamma U_Q'  R Phi^-1] = Q [. .; 0 R+]. Q_d may be singular; Phi may not: NaN.
  template <int NW>
  void predict(const Matrix& Phi, const Eigen::Matrix<Scalar, NX, NW>& Gamma,
               const Eigen::Matrix<Scalar, NW, NW>& Q_d) {
    constexpr int all = states::together(NW, NX);
    using Array = Eigen::Matrix<Scalar, all, all>;
    const Eigen::Index n_w = Q_d.cols();
    const Eigen::Index n_x = Phi.cols();
    const Matrix back =
        states::solve_square(Matrix(Phi.transpose()), Matrix(root_.transpose())).transpose();
    const Eigen::Matrix<Scalar, NW, NX> noise =
        states::product(states::upper_root(Q_d), Gamma.transpose());
    Array T = Array::Zero(n_w + n_x, n_w + n_x);
    T.template topLeftCorner<NW, NW>(n_w, n_w).setIdentity();
    Eigen::Matrix<Scalar, NX, all> rows(n_x, n_w + n_x);
    rows << -states::product(back, noise.transpose()), back;
    states::absorb_rows(T, rows);
    root_ = T.template bottomRightCorner<NX, NX>(n_x, n_x);
    for (Eigen::Index i = 0; i < n_x; ++i) {  // before a state that dies away is known beyond range
      const Scalar largest = root_.row(i).cwiseAbs().maxCoeff();
      if (largest > enough) root_.row(i) *= enough / largest;
    }
  }

  /// R absorbs U_R^-T C. The gain of S 2.10 by V = R^-T C': Lambda = V'V + R, Kbar = R^-1 V S^-1.
  template <int NZ>
  Gain<NX, NZ, Scalar> update(const Eigen::Matrix<Scalar, NZ, NX>& C,
                              const Eigen::Matrix<Scalar, NZ, NZ>& R) {
    const Eigen::Matrix<Scalar, NZ, NZ> U_R = states::upper_root(R);
    const Even even(root_);
    Eigen::Matrix<Scalar, NX, NZ> V =
        even.solve_transposed(Eigen::Matrix<Scalar, NX, NZ>(C.transpose()));
    const Eigen::Matrix<Scalar, NZ, NX> PC = even.solve(V).transpose();
    Eigen::Matrix<Scalar, NZ, NZ> S = U_R;
    states::absorb_rows(S, V);
    Eigen::Matrix<Scalar, NZ, NX> rows = states::solve_transposed(U_R, C);
    states::absorb_rows(root_, rows);
    if (!states::is_regular(Even(root_).root) || !states::is_regular(U_R)) {
      root_.setConstant(no_number);
    }
    return {S, states::solve_transposed(S, PC).transpose()};
  }

 private:
  /// R = S E with rows of E of size 1: what is nil in E has no information beside its own row, not
  /// beside the rows of states that die away, whose information grows without end.
  struct Even {
    Eigen::Vector<Scalar, NX> size;
    Matrix root;

    explicit Even(const Matrix& R)
        : size(R.cwiseAbs().rowwise().maxCoeff()), root(size.cwiseInverse().asDiagonal() * R) {}

    /// X with R'X = B.
    template <int M>
    Eigen::Matrix<Scalar, NX, M> solve_transposed(const Eigen::Matrix<Scalar, NX, M>& B) const {
      return size.cwiseInverse().asDiagonal() * states::solve_transposed(root, B);
    }
    /// X with R X = B.
    template <int M>
    Eigen::Matrix<Scalar, NX, M> solve(const Eigen::Matrix<Scalar, NX, M>& B) const {
      return states::solve_upper(root, size.cwiseInverse().asDiagonal() * B);
    }
  };

  static constexpr Scalar enough = std::same_as<Scalar, float> ? Scalar(1e12) : Scalar(1e100);
  static constexpr Scalar no_number = std::numeric_limits<Scalar>::quiet_NaN();

  InformationForm() = default;

  Matrix root_;
};

}  // namespace sepcal
