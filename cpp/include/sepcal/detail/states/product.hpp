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

}  // namespace sepcal::states
