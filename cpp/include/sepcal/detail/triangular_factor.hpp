// SPDX-License-Identifier: BSD-3-Clause
// The upper-triangular factor T of a tall matrix, T'T = rows' rows, gathered block by block with
// Householder reflections. Memory is one block however long the record; no normal equations, so
// nothing loses half its digits. Golub & Van Loan, Matrix Computations, Sec. 5.2 and 6.5.
#pragma once

#include <span>

#include "sepcal/detail/eigen.hpp"

namespace sepcal {

class TriangularFactor {
 public:
  /// Of `columns` columns, no rows yet: T = 0.
  explicit TriangularFactor(int columns);

  int columns() const { return static_cast<int>(matrix_.cols()); }

  /// Triangularises [T; rows], rows (any number x columns), scratch that is left destroyed. A NaN
  /// or an infinity in `rows` makes T not finite, which all_finite() tells.
  void absorb(Eigen::Ref<Eigen::MatrixXd> rows);

  /// Absorbs the rows behind another factor, each multiplied by `weight`: two flights, two threads
  /// or two machines become one factor, exactly. Throws Error for another number of columns.
  void merge(const TriangularFactor& other, double weight = 1.0);

  /// T (columns x columns), upper triangular, its diagonal not negative.
  const Eigen::MatrixXd& matrix() const { return matrix_; }

  bool all_finite() const { return matrix_.allFinite(); }

  /// Rank of the leading `count` columns scaled to unit length: singular values above
  /// `tolerance` times the largest. Default: count * machine epsilon.
  int rank(int count, double tolerance = -1.0) const;

  /// Condition number of the leading `count` columns scaled to unit length; infinity where a column
  /// is zero, 1 for count = 0.
  double condition(int count) const;

 private:
  Eigen::MatrixXd matrix_;
};

/// One factor of all outputs from one factor an output, output j's rows times weights[j]: a new
/// diagonal R re-weights a record with no further pass over it.
TriangularFactor combine(std::span<const TriangularFactor> factors, const Eigen::VectorXd& weights);

/// Minimiser of |R x - q| for an upper-triangular R (n x n) that may be singular, and the
/// directions that R does not see.
struct TriangularSolution {
  Eigen::VectorXd x;       // n, of least norm in columns scaled to unit length
  Eigen::MatrixXd unseen;  // n x (n - rank), orthonormal: left null space of R, its rows' U_perp
  int rank = 0;
};

/// Solves by back substitution where R is well conditioned, else by a singular value decomposition
/// of R with its columns scaled to unit length; singular values below n * epsilon of the largest
/// are zero.
TriangularSolution solve_triangular(const Eigen::MatrixXd& R, const Eigen::VectorXd& q);

/// The linear map behind solve_triangular(R, q).x, n x n: R's inverse, or one that gives the
/// solution of least norm in columns scaled to unit length.
Eigen::MatrixXd generalised_inverse(const Eigen::MatrixXd& R);

/// min over x of |last column - other columns x|^2 of the rows behind a factor.
double remaining_square(const TriangularFactor& factor);

}  // namespace sepcal
