// SPDX-License-Identifier: BSD-3-Clause
// What a candidate adds beyond a tangent, against dense least squares and projectors made from
// normal equations and symmetric eigenvalues, where the library takes QR and singular values.
#include "diagnosis/projection.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "linearisations.hpp"
#include "numerics/decompositions.hpp"
#include "simulated_records.hpp"

namespace diagnosis_projection_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace sepcal;

namespace {

constexpr Index rows = 200;
constexpr double least_visibility = 0.05;

/// I - J (J'J)^-1 J'.
MatrixXd annihilator(const MatrixXd& J) {
  return MatrixXd::Identity(J.rows(), J.rows()) -
         J * (J.transpose() * J).ldlt().solve(J.transpose());
}

/// |G_perp a|^2 / |whole a|^2 over all a, from the smallest to the largest.
VectorXd squared_sines(const MatrixXd& J, const MatrixXd& G, const MatrixXd& whole) {
  const MatrixXd left = annihilator(J) * G;
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(left.transpose() * left,
                                                                  whole.transpose() * whole);
  return solver.eigenvalues();
}

double worst(const MatrixXd& difference) { return difference.cwiseAbs().maxCoeff(); }

/// Projection with its columns made.
struct Seen {
  MatrixXd basis;
  MatrixXd to_effect;
  double visibility;

  Index visible() const { return basis.cols(); }
};

Seen project(const MatrixXd& J, const MatrixXd& G, const MatrixXd& whole, double least) {
  const auto count = static_cast<std::size_t>(J.rows());
  const diagnosis::LinearisedFit fit{
      test::make_layout({{"", count}}, {1.0}), {}, J, VectorXd::Zero(J.rows())};
  const diagnosis::TangentBasis tangent(fit);
  const diagnosis::Projection found = diagnosis::project(tangent, G, whole, least);
  return {found.basis.dense(fit.layout), found.to_effect, found.visibility};
}

/// A tangent of five columns and candidates of three, of different sizes.
struct Problem {
  test::Draws draws{3};
  MatrixXd J = draws.normal_matrix(rows, 5);
  MatrixXd G = (J * draws.normal_matrix(5, 3) + draws.normal_matrix(rows, 3)) *
               Eigen::Vector3d(1e-3, 1.0, 40.0).asDiagonal();
  VectorXd e = draws.normal_matrix(rows, 1);

  Seen projected() const { return project(J, G, G, least_visibility); }
};

}  // namespace

TEST_CASE("a basis in the tangent's place leaves what is explained and what is beyond") {
  const Problem problem;
  MatrixXd J(rows, 6);  // of rank five
  J << problem.J, problem.J.col(0) - 2.0 * problem.J.col(3);
  const diagnosis::LinearisedFit fit{
      test::make_layout({{"", rows}}, {1.0}), {}, J, VectorXd::Zero(rows)};
  diagnosis::LinearisedFit in_basis = fit;
  diagnosis::orthonormalise(in_basis);
  const MatrixXd& Q = in_basis.tangent;
  REQUIRE(Q.cols() == 5);
  CHECK(worst(Q.transpose() * Q - MatrixXd::Identity(5, 5)) < 1e-14);
  CHECK(worst(J * in_basis.weights - Q) < 1e-12);
  CHECK(worst(Q * in_basis.coordinates - J) < 1e-12);
  const diagnosis::TangentBasis tangent(fit);
  const diagnosis::TangentBasis basis(in_basis);
  CHECK(worst(basis.columns().dense(fit.layout) - Q) == 0.0);
  CHECK(worst(J * explained_by(basis, problem.G) - J * explained_by(tangent, problem.G)) < 1e-11);
  CHECK(worst(remove_tangent(basis, problem.G).dense(fit.layout) -
              remove_tangent(tangent, problem.G).dense(fit.layout)) < 1e-11);
}

TEST_CASE("an orthonormal basis spans the columns, of whatever size, in their numerical rank") {
  Problem problem;
  MatrixXd columns(rows, 7);
  columns << problem.J, problem.J.col(0) - 2.0 * problem.J.col(3), VectorXd::Zero(rows);
  columns.col(1) *= 1e8;
  columns.col(2) *= 1e-8;
  const MatrixXd Q = diagnosis::orthonormal_basis(columns);
  REQUIRE(Q.cols() == 5);
  CHECK(worst(Q.transpose() * Q - MatrixXd::Identity(5, 5)) < 1e-13);
  CHECK(worst(Q * Q.transpose() - MatrixXd::Identity(rows, rows) + annihilator(problem.J)) < 1e-12);
}

TEST_CASE("removing a span leaves what least squares leaves") {
  const Problem problem;
  const MatrixXd left = diagnosis::remove_span(diagnosis::orthonormal_basis(problem.J), problem.G);
  CHECK(worst(left - annihilator(problem.J) * problem.G) < 1e-10);
  CHECK(worst(problem.J.transpose() * left) < 1e-10);
  CHECK(diagnosis::remove_span(MatrixXd(rows, 0), problem.G) == problem.G);
}

TEST_CASE("what of a span lies within rounding of another is removed as well") {
  const Problem problem;
  const MatrixXd Q = diagnosis::orthonormal_basis(problem.J);
  const VectorXd near = 1e9 * problem.J.col(0) + problem.e;
  CHECK(worst(Q.transpose() * diagnosis::remove_span(Q, near)) < 1e-13);
}

TEST_CASE("a candidate that is seen whole spans what the tangent doesn't explain of it") {
  const Problem problem;
  const Seen projection = problem.projected();
  REQUIRE(projection.visible() == 3);
  const MatrixXd& B = projection.basis;
  CHECK(worst(B.transpose() * B - MatrixXd::Identity(3, 3)) < 1e-13);
  CHECK(worst(B.transpose() * problem.J) < 1e-12);
  MatrixXd both(rows, 8);
  both << problem.J, problem.G;
  CHECK(worst(annihilator(problem.J) - B * B.transpose() - annihilator(both)) < 1e-11);
}

TEST_CASE("visibility is the smallest sine between the candidate and the tangent") {
  const Problem problem;
  const VectorXd squares = squared_sines(problem.J, problem.G, problem.G);
  CHECK(problem.projected().visibility == Approx(std::sqrt(squares[0])).epsilon(1e-10));
  const MatrixXd centred = problem.G.rowwise() - problem.G.colwise().mean();
  const Seen varying = project(problem.J, problem.G, centred, least_visibility);
  CHECK(varying.visibility ==
        Approx(std::min(1.0, std::sqrt(squared_sines(problem.J, problem.G, centred)[0]))));
}

TEST_CASE("the coefficients behind the basis are those of least squares with the tangent") {
  const Problem problem;
  const Seen projection = problem.projected();
  MatrixXd both(rows, 8);
  both << problem.J, problem.G;
  const VectorXd expected = (both.transpose() * both).ldlt().solve(both.transpose() * problem.e);
  const VectorXd found = projection.to_effect * (projection.basis.transpose() * problem.e);
  for (Index k = 0; k < 3; ++k) CHECK(found[k] == Approx(expected[5 + k]).epsilon(1e-9));
}

TEST_CASE("the coefficients don't depend on what visibility is measured against") {
  const Problem problem;
  const MatrixXd centred = problem.G.rowwise() - problem.G.colwise().mean();
  const Seen plain = project(problem.J, problem.G, problem.G, 0.0);
  const Seen varying = project(problem.J, problem.G, centred, 0.0);
  const VectorXd a = plain.to_effect * (plain.basis.transpose() * problem.e);
  const VectorXd b = varying.to_effect * (varying.basis.transpose() * problem.e);
  for (Index k = 0; k < 3; ++k) CHECK(a[k] == Approx(b[k]).epsilon(1e-9));
}

TEST_CASE("one direction that the tangent all but contains is left out of the basis") {
  Problem problem;
  problem.G.col(1) = problem.J * Eigen::VectorXd::LinSpaced(5, 1.0, 2.0) + 0.01 * problem.e;
  const VectorXd squares = squared_sines(problem.J, problem.G, problem.G);
  REQUIRE(squares[0] < least_visibility * least_visibility);
  REQUIRE(squares[1] > least_visibility * least_visibility);
  const Seen projection = problem.projected();
  CHECK(projection.visibility == Approx(std::sqrt(squares[0])).epsilon(1e-8));
  REQUIRE(projection.visible() == 2);

  // The others are seen: their sum of squares is least squares with those directions alone.
  const MatrixXd seen = problem.G * projection.to_effect;
  CHECK(worst(diagnosis::remove_span(diagnosis::orthonormal_basis(problem.J), seen) -
              projection.basis) < 1e-10);
  const MatrixXd every = project(problem.J, problem.G, problem.G, 0.0).basis;
  REQUIRE(every.cols() == 3);
  CHECK(worst(every.leftCols(2) - projection.basis) < 1e-10);
}

TEST_CASE("nothing is seen of a candidate within the tangent, nor of one that is deficient") {
  Problem problem;
  const MatrixXd within = problem.J.leftCols(2);
  const Seen hidden = project(problem.J, within, within, least_visibility);
  CHECK(hidden.visible() == 0);
  CHECK(hidden.visibility < 1e-12);

  problem.G.col(2) = problem.G.col(0);
  CHECK(problem.projected().visible() == 0);
  CHECK(problem.projected().visibility == 0.0);
  problem.G.col(2).setZero();
  CHECK(problem.projected().visible() == 0);

  const MatrixXd wide = problem.draws.normal_matrix(4, 6);
  CHECK(project(MatrixXd(4, 0), wide, wide, least_visibility).visible() == 0);
}

}  // namespace diagnosis_projection_test
