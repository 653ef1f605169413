// SPDX-License-Identifier: BSD-3-Clause
// exp(A) of a small matrix, S 3.9, by scaling, a Pade approximant and squaring. Golub & Van Loan,
// Algorithm 11.3.1: with |A| / 2^s <= 1/2 and order six the result is that of a matrix which
// differs from A by 4e-16 of it. Other than the sum of S 3.9, it doesn't lose what cancels in A^n /
// n!.
#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <utility>

#include "sepcal/detail/lanewise.hpp"
#include "sepcal/detail/states/product.hpp"

namespace sepcal {
namespace states {

/// The largest sum of magnitudes in a column, |A|_1. Of dual numbers too.
template <class T, int N>
T column_norm(const Eigen::Matrix<T, N, N>& A) {
  using std::abs;
  T norm(Real<T>(0));
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    T sum(Real<T>(0));
    for (Eigen::Index i = 0; i < A.rows(); ++i) sum += abs(A(i, j));
    if (!(sum <= norm)) norm = sum;  // a NaN stays
  }
  return norm;
}

/// Makes columns of A as long as their rows by d, powers of two: A <- D^-1 A D, so that units which
/// differ don't cost squarings. Parlett & Reinsch, Numerische Mathematik 13 (1969) 293.
template <class T, int N>
Eigen::Vector<Real<T>, N> balance(Eigen::Matrix<T, N, N>& A) {
  using std::abs;
  constexpr int sweeps = 20;
  constexpr Real<T> most = std::same_as<Real<T>, float> ? Real<T>(1e9) : Real<T>(1e100);
  Eigen::Vector<Real<T>, N> d = Eigen::Vector<Real<T>, N>::Ones(A.rows());
  bool changed = true;
  for (int sweep = 0; changed && sweep < sweeps; ++sweep) {
    changed = false;
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      T column(Real<T>(0));
      T row(Real<T>(0));
      for (Eigen::Index j = 0; j < A.rows(); ++j) {
        if (j == i) continue;
        column += abs(A(j, i));
        row += abs(A(i, j));
      }
      Real<T> factor = 1;
      while (column > T(Real<T>(0)) && column * T(4 * factor * factor) <= row && factor < most)
        factor *= 2;
      while (row > T(Real<T>(0)) && column * T(factor * factor) >= row * T(Real<T>(4)) &&
             factor > 1 / most)
        factor /= 2;
      if (factor == 1) continue;
      changed = true;
      d[i] *= factor;
      for (Eigen::Index j = 0; j < A.rows(); ++j) {
        if (j == i) continue;
        A(j, i) *= T(factor);
        A(i, j) *= T(1 / factor);
      }
    }
  }
  return d;
}

/// How often A must be halved to have a norm of at most 1/2; -1 where A is not finite or beyond
/// 2^1000.
template <class T, int N>
int count_halvings(const Eigen::Matrix<T, N, N>& A) {
  T norm = column_norm(A);
  int count = 0;
  while (norm > T(Real<T>(0.5)) && count < 1000) {
    norm *= T(Real<T>(0.5));
    ++count;
  }
  return norm <= T(Real<T>(0.5)) ? count : -1;
}

/// X with A X = B, by elimination with row pivots. Not finite where A is singular.
template <class T, int N>
Eigen::Matrix<T, N, N> eliminate(Eigen::Matrix<T, N, N> A, Eigen::Matrix<T, N, N> B) {
  using std::abs;
  using std::swap;
  const Eigen::Index n = A.rows();
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::Index pivot = k;
    for (Eigen::Index i = k + 1; i < n; ++i) {
      if (abs(A(i, k)) > abs(A(pivot, k))) pivot = i;
    }
    for (Eigen::Index j = 0; j < n; ++j) {
      swap(A(k, j), A(pivot, j));
      swap(B(k, j), B(pivot, j));
    }
    for (Eigen::Index i = k + 1; i < n; ++i) {
      const T factor = A(i, k) / A(k, k);
      for (Eigen::Index j = k + 1; j < n; ++j) A(i, j) -= factor * A(k, j);
      for (Eigen::Index j = 0; j < n; ++j) B(i, j) -= factor * B(k, j);
    }
  }
  for (Eigen::Index k = n - 1; k >= 0; --k) {
    for (Eigen::Index j = 0; j < n; ++j) {
      for (Eigen::Index i = k + 1; i < n; ++i) B(k, j) -= A(k, i) * B(i, j);
      B(k, j) /= A(k, k);
    }
  }
  return B;
}

}  // namespace states

/// exp(A), N x N (N may be Eigen::Dynamic), of doubles or dual numbers; all NaN where A is not
/// finite.
template <class T, int N>
Eigen::Matrix<T, N, N> matrix_exponential(const Eigen::Matrix<T, N, N>& A) {
  using Matrix = Eigen::Matrix<T, N, N>;
  Matrix balanced = A;
  const Eigen::Vector<Real<T>, N> d = states::balance(balanced);
  const int halvings = states::count_halvings(balanced);
  const Eigen::Index n = A.rows();
  if (halvings < 0) return Matrix::Constant(n, n, T(std::numeric_limits<Real<T>>::quiet_NaN()));
  const Matrix scaled = balanced * T(std::ldexp(Real<T>(1), -halvings));

  constexpr int order = 6;
  Real<T> coefficient = 1;
  Matrix power = Matrix::Identity(n, n);
  Matrix above = power;  // of the rational function, N(A) / N(-A)
  Matrix below = power;
  for (int k = 1; k <= order; ++k) {
    coefficient *=
        static_cast<Real<T>>(order - k + 1) / static_cast<Real<T>>(k * (2 * order - k + 1));
    power = states::product(scaled, power);
    above += power * T(coefficient);
    below += power * T(k % 2 == 0 ? coefficient : -coefficient);
  }
  Matrix result = states::eliminate(below, above);
  for (int k = 0; k < halvings; ++k) result = states::product(result, result);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) result(i, j) *= T(d[i] / d[j]);
  }
  return result;
}

}  // namespace sepcal
