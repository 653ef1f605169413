// SPDX-License-Identifier: BSD-3-Clause
// Products of fixed-size matrices that never ask for memory. From twenty rows and columns on,
// Eigen's own * calls a kernel for large matrices that may allocate; flight software links no
// allocator. Filters on a PC may have Eigen::Dynamic for a size, and then do ask for memory.
#pragma once

#include "sepcal/detail/eigen.hpp"

namespace sepcal::states {

/// a + b rows or columns; Eigen::Dynamic where either is.
constexpr int together(int a, int b) {
  return a == Eigen::Dynamic || b == Eigen::Dynamic ? Eigen::Dynamic : a + b;
}

/// a b entries; Eigen::Dynamic where either is.
constexpr int times(int a, int b) {
  return a == Eigen::Dynamic || b == Eigen::Dynamic ? Eigen::Dynamic : a * b;
}

/// Zeros of a fixed size; a size that is Eigen::Dynamic begins as none.
template <class Matrix>
Matrix zeros() {
  constexpr int rows = Matrix::RowsAtCompileTime;
  constexpr int columns = Matrix::ColsAtCompileTime;
  return Matrix::Zero(rows == Eigen::Dynamic ? 0 : rows, columns == Eigen::Dynamic ? 0 : columns);
}

/// A B, evaluated. May be assigned to A or B.
template <class A, class B>
auto product(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  using Product = Eigen::Matrix<typename A::Scalar, A::RowsAtCompileTime, B::ColsAtCompileTime>;
  return Product(a.derived().lazyProduct(b.derived()));
}

/// A B C ..., from left to right.
template <class A, class B, class... More>
auto product(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b,
             const Eigen::MatrixBase<More>&... more)
  requires(sizeof...(More) > 0)
{
  return product(product(a, b), more...);
}

/// to += factor from, of columns; nothing where the factor is zero.
template <class From, class To>
void add_times(double factor, const From& from, const Eigen::MatrixBase<To>& to) {
  if (factor != 0.0) to.const_cast_derived() += factor * from;  // a column may be a temporary view
}

/// Of a matrix with n rows the slopes by many variables: a row a variable, a column an entry,
/// column by column. Adds to `to` the slopes of A B, those of A being `slopes`.
template <class Slopes, class B, class To>
void add_slopes_times(const Slopes& slopes, const B& b, To& to) {
  const Eigen::Index n = slopes.cols() / b.rows();
  for (Eigen::Index k = 0; k < b.cols(); ++k) {
    for (Eigen::Index a = 0; a < b.rows(); ++a) {
      if (b(a, k) == 0.0) continue;
      for (Eigen::Index i = 0; i < n; ++i) to.col(i + n * k) += b(a, k) * slopes.col(i + n * a);
    }
  }
}

/// The same, those of B being `slopes`.
template <class A, class Slopes, class To>
void add_times_slopes(const A& a, const Slopes& slopes, To& to) {
  const Eigen::Index columns = slopes.cols() / a.cols();
  for (Eigen::Index j = 0; j < a.cols(); ++j) {
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      if (a(i, j) == 0.0) continue;
      for (Eigen::Index k = 0; k < columns; ++k) {
        to.col(i + a.rows() * k) += a(i, j) * slopes.col(j + a.cols() * k);
      }
    }
  }
}

}  // namespace sepcal::states
