// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/triangular_factor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "numerics/decompositions.hpp"
#include "numerics/plain_pivot.hpp"
#include "numerics/safe_squares.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double length_of(const Eigen::Ref<const VectorXd>& x) {
  const double square = x.squaredNorm();
  if (std::isnan(square)) return square;  // stableNorm() drops some NaNs
  const bool safe =
      square > numerics::smallest_safe_square && square < numerics::largest_safe_square;
  return safe ? std::sqrt(square) : x.stableNorm();
}

// Singular values below this part of the largest are rounding: A's columns carry a few digits of
// error.
constexpr double singular_floor = 1e-12;

struct Scaled {
  MatrixXd matrix;   // columns of unit length, zero columns left as they are
  VectorXd lengths;  // what they were divided by; 1 for a zero column
};

Scaled scale_columns(const Eigen::Ref<const MatrixXd>& matrix) {
  Scaled scaled{matrix, VectorXd::Ones(matrix.cols())};
  for (Index k = 0; k < matrix.cols(); ++k) {
    const double length = matrix.col(k).stableNorm();
    if (length > 0) {
      scaled.lengths[k] = length;
      scaled.matrix.col(k) /= length;
    }
  }
  return scaled;
}

double default_tolerance(Index count) {
  return static_cast<double>(std::max<Index>(count, 1)) * std::numeric_limits<double>::epsilon();
}

}  // namespace

TriangularFactor::TriangularFactor(int columns) : matrix_(MatrixXd::Zero(columns, columns)) {}

void TriangularFactor::absorb(Eigen::Ref<MatrixXd> rows) {
  const Index n = matrix_.cols();
  if (rows.cols() != n) {
    throw Error("TriangularFactor: rows have " + std::to_string(rows.cols()) +
                " columns, the factor has " + std::to_string(n));
  }
  VectorXd projection(n);
  for (Index k = 0; k < n; ++k) {
    // The reflector I - tau v v' with v = [v0; x] maps [T(k,k); x] onto a multiple of e_1.
    auto x = rows.col(k);
    const double pivot = matrix_(k, k);
    const double tail = length_of(x);
    if (tail == 0.0) continue;
    const double length = std::hypot(pivot, tail);
    const double reflected = pivot > 0 ? -length : length;
    // v is divided by v0, so that it neither overflows nor underflows: v = [1; x / v0].
    const double v0 = pivot - reflected;
    x /= v0;
    const double tau = -v0 / reflected;
    matrix_(k, k) = reflected;
    const Index rest = n - k - 1;
    if (rest == 0) continue;
    auto w = projection.head(rest);
    w.noalias() = rows.rightCols(rest).transpose() * x;
    w += matrix_.row(k).tail(rest).transpose();
    w *= tau;
    matrix_.row(k).tail(rest) -= w.transpose();
    rows.rightCols(rest).noalias() -= x * w.transpose();
  }
  for (Index k = 0; k < n; ++k) {
    if (matrix_(k, k) < 0) matrix_.row(k).tail(n - k) *= -1.0;
  }
}

void TriangularFactor::merge(const TriangularFactor& other, double weight) {
  MatrixXd rows = weight * other.matrix_;
  absorb(rows);
}

int TriangularFactor::rank(int count, double tolerance) const {
  if (count == 0) return 0;
  const VectorXd singular =
      Eigen::JacobiSVD<MatrixXd>(scale_columns(matrix_.topLeftCorner(count, count)).matrix)
          .singularValues();
  const double limit = (tolerance < 0 ? default_tolerance(count) : tolerance) * singular[0];
  return static_cast<int>((singular.array() > limit).count());
}

double TriangularFactor::condition(int count) const {
  if (count == 0) return 1.0;
  const VectorXd singular =
      Eigen::JacobiSVD<MatrixXd>(scale_columns(matrix_.topLeftCorner(count, count)).matrix)
          .singularValues();
  const double smallest = singular[count - 1];
  return smallest > 0 ? singular[0] / smallest : std::numeric_limits<double>::infinity();
}

TriangularFactor combine(std::span<const TriangularFactor> factors, const VectorXd& weights) {
  TriangularFactor combined(factors.front().columns());
  for (std::size_t j = 0; j < factors.size(); ++j) {
    combined.merge(factors[j], weights[static_cast<Index>(j)]);
  }
  return combined;
}

TriangularSolution solve_triangular(const MatrixXd& R, const VectorXd& q) {
  const Index n = R.cols();
  TriangularSolution solution{VectorXd::Zero(n), MatrixXd(n, 0), static_cast<int>(n)};
  if (n == 0) return solution;

  bool plain = true;
  for (Index k = 0; k < n && plain; ++k) {
    plain = std::abs(R(k, k)) > numerics::smallest_plain_pivot * R.col(k).head(k + 1).norm();
  }
  if (plain) {
    solution.x = R.triangularView<Eigen::Upper>().solve(q);
    return solution;
  }
  const Scaled scaled = scale_columns(R);
  Eigen::JacobiSVD<MatrixXd> svd(scaled.matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  svd.setThreshold(singular_floor);
  solution.rank = static_cast<int>(svd.rank());
  solution.x = svd.solve(q).cwiseQuotient(scaled.lengths);
  solution.unseen = svd.matrixU().rightCols(n - solution.rank);
  return solution;
}

MatrixXd generalised_inverse(const MatrixXd& R) {
  MatrixXd inverse(R.cols(), R.cols());
  for (Index k = 0; k < R.cols(); ++k) {
    inverse.col(k) = solve_triangular(R, VectorXd::Unit(R.cols(), k)).x;
  }
  return inverse;
}

double remaining_square(const TriangularFactor& factor) {
  const MatrixXd& T = factor.matrix();
  const Index n = T.cols() - 1;
  const VectorXd q = T.col(n).head(n);
  const TriangularSolution solution = solve_triangular(T.topLeftCorner(n, n), q);
  return (solution.unseen.transpose() * q).squaredNorm() + T(n, n) * T(n, n);
}

}  // namespace sepcal
