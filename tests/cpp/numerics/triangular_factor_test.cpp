// SPDX-License-Identifier: BSD-3-Clause
// The streamed triangular factor against Eigen's QR and SVD of the whole matrix.
#include "sepcal/detail/triangular_factor.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "numerics/decompositions.hpp"
#include "sepcal/error.hpp"
#include "simulated_records.hpp"

namespace triangular_factor_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::TriangularFactor;
using sepcal::test::Draws;

namespace {

TriangularFactor factor_of(MatrixXd rows) {
  TriangularFactor factor(static_cast<int>(rows.cols()));
  factor.absorb(rows);
  return factor;
}

TriangularFactor factor_in_blocks(const MatrixXd& rows, Index block) {
  TriangularFactor factor(static_cast<int>(rows.cols()));
  for (Index first = 0; first < rows.rows(); first += block) {
    MatrixXd part = rows.middleRows(first, std::min(block, rows.rows() - first));
    factor.absorb(part);
  }
  return factor;
}

/// R of the whole matrix's QR, its diagonal made positive.
MatrixXd whole_factor(const MatrixXd& rows) {
  const Index n = rows.cols();
  MatrixXd R = Eigen::HouseholderQR<MatrixXd>(rows).matrixQR().topRows(n);
  R.triangularView<Eigen::StrictlyLower>().setZero();
  for (Index k = 0; k < n; ++k) {
    if (R(k, k) < 0) R.row(k) *= -1;
  }
  return R;
}

MatrixXd orthonormal(Index rows, Index columns, Draws& draws) {
  const MatrixXd any = draws.normal_matrix(rows, columns);
  return Eigen::HouseholderQR<MatrixXd>(any).householderQ() * MatrixXd::Identity(rows, columns);
}

}  // namespace

TEST_CASE("rows absorbed in blocks of any size give the factor of the whole matrix") {
  Draws draws(1);
  const MatrixXd rows = draws.normal_matrix(257, 7);
  const MatrixXd expected = whole_factor(rows);
  for (const Index block : {1, 2, 3, 7, 8, 64, 256, 257}) {
    const TriangularFactor factor = factor_in_blocks(rows, block);
    const MatrixXd& T = factor.matrix();
    CHECK((T - expected).norm() < 1e-13 * expected.norm());
    CHECK((T.transpose() * T - rows.transpose() * rows).norm() < 1e-13 * rows.squaredNorm());
    CHECK((T.diagonal().array() >= 0).all());
    CHECK(T.isUpperTriangular(0.0));
  }
}

TEST_CASE("fewer rows than columns, and no rows at all, are a factor too") {
  Draws draws(2);
  const MatrixXd rows = draws.normal_matrix(3, 5);
  const MatrixXd T = factor_of(rows).matrix();
  CHECK((T.transpose() * T - rows.transpose() * rows).norm() < 1e-13 * rows.squaredNorm());
  CHECK(factor_of(rows).rank(5) == 3);
  CHECK(factor_of(MatrixXd(0, 4)).matrix() == MatrixXd::Zero(4, 4));
}

TEST_CASE("merging two halves is the factor of the whole; a weight multiplies the other's rows") {
  Draws draws(3);
  const MatrixXd a = draws.normal_matrix(40, 6);
  const MatrixXd b = draws.normal_matrix(70, 6);
  MatrixXd whole(110, 6);
  for (const double weight : {1.0, 0.0, 2.5, 1e-8}) {
    whole << a, weight * b;
    TriangularFactor merged = factor_of(a);
    merged.merge(factor_of(b), weight);
    const MatrixXd expected = whole_factor(whole);
    CHECK((merged.matrix() - expected).norm() < 1e-13 * expected.norm());
  }
}

TEST_CASE("combining one factor an output re-weights the record") {
  Draws draws(4);
  const MatrixXd a = draws.normal_matrix(30, 4);
  const MatrixXd b = draws.normal_matrix(50, 4);
  MatrixXd whole(80, 4);
  whole << 3.0 * a, 0.25 * b;
  const TriangularFactor parts[] = {factor_of(a), factor_of(b)};
  const MatrixXd expected = whole_factor(whole);
  const MatrixXd T = sepcal::combine(parts, Eigen::Vector2d(3.0, 0.25)).matrix();
  CHECK((T - expected).norm() < 1e-13 * expected.norm());
}

TEST_CASE("another number of columns is an error that gives both") {
  TriangularFactor factor(3);
  CHECK_THROWS_WITH_AS(factor.merge(TriangularFactor(4)), doctest::Contains("4 columns"),
                       sepcal::Error);
}

TEST_CASE("rank and condition are those of the columns at unit length") {
  Draws draws(5);
  // Two columns at an angle t have singular values sqrt(1 +- cos t) at unit length.
  const MatrixXd Q = orthonormal(60, 3, draws);
  for (const double t : {1.0, 1e-2, 1e-5}) {
    MatrixXd rows(60, 3);
    rows << 1e6 * Q.col(0), 1e-6 * (std::cos(t) * Q.col(0) + std::sin(t) * Q.col(1)), Q.col(2);
    const TriangularFactor factor = factor_of(rows);
    CHECK(factor.condition(2) == Approx(1.0 / std::tan(0.5 * t)).epsilon(1e-9));
    CHECK(factor.rank(3) == 3);
    CHECK(factor.rank(2, 1e-3) == (t < 1e-3 ? 1 : 2));
  }
}

TEST_CASE("a column repeated costs a rank, a column of zeros makes the condition infinite") {
  Draws draws(6);
  MatrixXd rows = draws.normal_matrix(30, 4);
  rows.col(2) = 3.0 * rows.col(0) - rows.col(1);
  CHECK(factor_of(rows).rank(4) == 3);
  CHECK(factor_of(rows).rank(2) == 2);
  CHECK(factor_of(rows).condition(3) > 1e14);
  rows.col(1).setZero();
  CHECK(factor_of(rows).condition(2) == std::numeric_limits<double>::infinity());
  CHECK(factor_of(rows).rank(2) == 1);
  CHECK(factor_of(rows).rank(0) == 0);
  CHECK(factor_of(rows).condition(0) == 1.0);
  CHECK(TriangularFactor(3).rank(3) == 0);
}

TEST_CASE("at condition 1e10 the solution has QR's accuracy, which normal equations lose") {
  Draws draws(7);
  const MatrixXd U = orthonormal(200, 5, draws);
  const MatrixXd V = orthonormal(5, 5, draws);
  VectorXd singular(5);
  singular << 1, 1e-3, 1e-5, 1e-8, 1e-10;
  const MatrixXd A = U * singular.asDiagonal() * V.transpose();
  const VectorXd truth = VectorXd::LinSpaced(5, 1, 2);
  const VectorXd z = A * truth;
  MatrixXd rows(200, 6);
  rows << A, z;
  const MatrixXd T = factor_in_blocks(rows, 32).matrix();
  const VectorXd x = sepcal::solve_triangular(T.topLeftCorner(5, 5), T.col(5).head(5)).x;
  const VectorXd squared = (A.transpose() * A).ldlt().solve(A.transpose() * z);
  CHECK((x - truth).norm() < 1e-4);
  CHECK_FALSE((squared - truth).norm() < 1e-2);
}

TEST_CASE("huge and tiny scales neither overflow nor underflow") {
  Draws draws(8);
  const MatrixXd rows = draws.normal_matrix(50, 4);
  const MatrixXd expected = whole_factor(rows);
  for (const double scale : {1e150, 1e200, 1e-150, 1e-200}) {
    const MatrixXd T = factor_in_blocks(scale * rows, 16).matrix() / scale;
    CHECK((T - expected).norm() < 1e-13 * expected.norm());
  }
  Eigen::Vector4d mixed(1e150, 1.0, 1e-150, 1e-170);
  const MatrixXd T = factor_in_blocks(rows * mixed.asDiagonal(), 16).matrix();
  CHECK((T * mixed.cwiseInverse().asDiagonal() - expected).norm() < 1e-13 * expected.norm());
  CHECK(factor_of(rows * mixed.asDiagonal()).rank(4) == 4);
}

TEST_CASE("a NaN or an infinity anywhere makes the factor not finite, and it stays so") {
  Draws draws(9);
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(), INFINITY, -INFINITY};
  for (const double value : bad) {
    for (const bool among_zeros : {false, true}) {
      for (Index row = 0; row < 9; ++row) {
        for (Index column = 0; column < 3; ++column) {
          MatrixXd rows = draws.normal_matrix(9, 3);
          if (among_zeros) rows.col(column).setZero();
          rows(row, column) = value;
          TriangularFactor factor = factor_of(rows);
          CAPTURE(value);
          CAPTURE(among_zeros);
          CAPTURE(row);
          CAPTURE(column);
          CHECK_FALSE(factor.all_finite());
          MatrixXd good = draws.normal_matrix(9, 3);
          factor.absorb(good);
          CHECK_FALSE(factor.all_finite());
        }
      }
    }
  }
}

TEST_CASE("what remains is the distance from the last column to the others, singular or not") {
  Draws draws(10);
  for (const bool singular : {false, true}) {
    MatrixXd rows = draws.normal_matrix(40, 5);
    if (singular) {
      rows.col(1) = -2.0 * rows.col(0);
      rows.col(3).setZero();
    }
    const MatrixXd A = rows.leftCols(4);
    const VectorXd z = rows.col(4);
    const VectorXd x =
        Eigen::JacobiSVD<MatrixXd>(A, Eigen::ComputeThinU | Eigen::ComputeThinV).solve(z);
    CHECK(sepcal::remaining_square(factor_in_blocks(rows, 7)) ==
          Approx((z - A * x).squaredNorm()).epsilon(1e-12));
  }
  CHECK(sepcal::remaining_square(factor_of(VectorXd::Constant(4, 3.0))) == Approx(36.0));
}

TEST_CASE("a singular triangle is solved with least norm, and what it doesn't see is orthonormal") {
  Draws draws(11);
  MatrixXd rows = draws.normal_matrix(20, 4);
  rows.col(2) = rows.col(0) + rows.col(1);
  const MatrixXd R = factor_of(rows).matrix();
  const VectorXd q = draws.normal_matrix(4, 1);
  const auto solution = sepcal::solve_triangular(R, q);
  CHECK(solution.rank == 3);

  // The same in columns of unit length by a complete orthogonal decomposition.
  const VectorXd lengths = R.colwise().norm();
  const MatrixXd scaled = R * lengths.cwiseInverse().asDiagonal();
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposition;
  decomposition.setThreshold(1e-12);
  decomposition.compute(scaled);
  const VectorXd expected = decomposition.solve(q).cwiseQuotient(lengths);
  CHECK((solution.x - expected).norm() < 1e-12 * expected.norm());

  REQUIRE(solution.unseen.cols() == 1);
  CHECK((solution.unseen.transpose() * solution.unseen - MatrixXd::Identity(1, 1)).norm() < 1e-14);
  CHECK((solution.unseen.transpose() * R).norm() < 1e-13 * R.norm());
}

TEST_CASE("a regular triangle leaves nothing unseen, and order zero is allowed") {
  Draws draws(12);
  const MatrixXd R = factor_of(draws.normal_matrix(20, 4)).matrix();
  const VectorXd truth = draws.normal_matrix(4, 1);
  const auto solution = sepcal::solve_triangular(R, R * truth);
  CHECK((solution.x - truth).norm() < 1e-13);
  CHECK(solution.rank == 4);
  CHECK(solution.unseen.cols() == 0);
  CHECK(sepcal::solve_triangular(MatrixXd(0, 0), VectorXd(0)).x.size() == 0);
}

}  // namespace triangular_factor_test
