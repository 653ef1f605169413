// SPDX-License-Identifier: BSD-3-Clause
// What a record leaves open, in words.
#include "sepcal/detail/identifiability.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "numerics/decompositions.hpp"
#include "simulated_records.hpp"

namespace identifiability_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::identify;
using sepcal::test::Draws;

namespace {

using Names = std::vector<std::string>;

/// n orthonormal columns of length 100: far from any doubt at a scale of one.
MatrixXd clear_columns(Index n) {
  Draws draws(31);
  const MatrixXd any = draws.normal_matrix(3 * n, n);
  return 100.0 *
         (Eigen::HouseholderQR<MatrixXd>(any).householderQ() * MatrixXd::Identity(3 * n, n));
}

MatrixXd triangle(const MatrixXd& rows) {
  return Eigen::HouseholderQR<MatrixXd>(rows)
      .matrixQR()
      .topRows(rows.cols())
      .triangularView<Eigen::Upper>();
}

VectorXd ones(Index n) { return VectorXd::Ones(n); }

}  // namespace

TEST_CASE("a clear record has nothing to say") {
  const auto result = identify(triangle(clear_columns(3)), {"a", "b", "c"}, ones(3), 1.0);
  CHECK(result.unobservable.empty());
  CHECK(result.weak.empty());
  CHECK(result.message().empty());
  CHECK(result.rank == 3);
  CHECK(identify(MatrixXd(0, 0), {}, VectorXd(0), 1.0).message().empty());
}

TEST_CASE("two parameters that can't be told apart are named with what is determined") {
  MatrixXd rows = clear_columns(3);
  const VectorXd seen = rows.col(0);
  rows.col(0) = 0.8 * seen;
  rows.col(1) = -0.6 * seen;
  const auto result =
      identify(triangle(rows), {"w_n", "lambda_va", "b"}, Eigen::Vector3d(1, 2, 1), 1.0);
  CHECK(result.message() ==
        "w_n and lambda_va can't be told apart: only 0.8 w_n - 0.6 lambda_va is determined");
  CHECK(result.rank == 2);
  REQUIRE(result.unobservable.size() == 1);
  CHECK(result.unobservable[0].parameters == Names{"w_n", "lambda_va"});
  CHECK(std::isinf(result.unobservable[0].standard_error));
}

TEST_CASE("parameters that nothing sees are named, each for itself") {
  MatrixXd rows = clear_columns(4);
  rows.col(2).setZero();
  CHECK(identify(triangle(rows), {"a", "b", "c", "d"}, ones(4), 1.0).message() ==
        "c can't be determined from this record");
  rows.col(0).setZero();
  const auto result = identify(triangle(rows), {"a", "b", "c", "d"}, ones(4), 1.0);
  REQUIRE(result.unobservable.size() == 2);
  CHECK(result.rank == 2);
  const bool a_first = result.unobservable[0].parameters == Names{"a"};
  CHECK(result.unobservable[a_first ? 0 : 1].parameters == Names{"a"});
  CHECK(result.unobservable[a_first ? 1 : 0].parameters == Names{"c"});
  CHECK(result.unobservable[0].text == (a_first ? "a" : "c"));
  CHECK(result.message() == (a_first ? "a and c can't be determined from this record"
                                     : "c and a can't be determined from this record"));
}

TEST_CASE("three parameters in one dependency are one combination that is not determined") {
  MatrixXd rows = clear_columns(4);
  rows.col(2) = -rows.col(0) - rows.col(1);  // (1, 1, 1) leaves the residuals as they are
  const auto result = identify(triangle(rows), {"a", "b", "c", "d"}, ones(4), 1.0);
  REQUIRE(result.unobservable.size() == 1);
  CHECK(result.unobservable[0].parameters.size() == 3);
  CHECK(result.unobservable[0].text == "0.577 a + 0.577 b + 0.577 c");
  CHECK(result.message().ends_with(
      "can't be told apart: 0.577 a + 0.577 b + 0.577 c is not determined"));
}

TEST_CASE("a message lists the first few of many and counts the others") {
  Names names;
  for (Index k = 0; k < 14; ++k) names.push_back("x_" + std::to_string(k));
  // Six pairs of equal columns, then four.
  MatrixXd rows = clear_columns(14);
  for (Index k = 0; k < 12; k += 2) rows.col(k + 1) = rows.col(k);
  const auto six = identify(triangle(rows), names, ones(14), 1.0);
  CHECK(six.unobservable.size() == 6);
  REQUIRE(six.sentences.size() == 6);
  CHECK(six.message() == six.sentences[0] + "; " + six.sentences[1] + "; " + six.sentences[2] +
                             "; and 3 more (see unobservable and weak)");
  const auto four = identify(triangle(rows.rightCols(10)), names, ones(10), 1.0);
  CHECK(four.sentences.size() == 4);
  CHECK(four.message().find(" more ") == std::string::npos);

  // One column twelve times: one group of eleven combinations.
  rows = clear_columns(14);
  for (Index k = 1; k < 12; ++k) rows.col(k) = rows.col(0);
  const auto group = identify(triangle(rows), names, ones(14), 1.0);
  CHECK(group.unobservable.size() == 11);
  REQUIRE(group.sentences.size() == 1);
  CHECK(group.message().find(" and 4 more can't be told apart: ") != std::string::npos);
  CHECK(group.message().ends_with(" and 8 more (see unobservable) are not determined"));
}

TEST_CASE("the weakest combination comes first") {
  // Pairs of columns at a small angle t, and at half of it.
  MatrixXd rows = clear_columns(4);
  const double t = 0.01;
  rows.col(1) = std::cos(t) * rows.col(0) + std::sin(t) * rows.col(1);
  rows.col(3) = std::cos(t / 2) * rows.col(2) + std::sin(t / 2) * rows.col(3);
  const auto result = identify(triangle(rows), {"a", "b", "c", "d"}, 1e3 * ones(4), 1.0);
  REQUIRE(result.weak.size() == 2);
  CHECK(result.weak[0].text == "0.707 c - 0.707 d");
  CHECK(result.weak[1].text == "0.707 a - 0.707 b");
  CHECK(result.message().starts_with("c and d are hard to tell apart"));
}

TEST_CASE("an uncertainty beyond the scale is unobservable though nothing is singular") {
  MatrixXd rows = clear_columns(2);
  rows.col(1) *= 1e-2;  // a standard error of 1
  const Names names{"a", "b"};
  const auto within = identify(triangle(rows), names, Eigen::Vector2d(1, 1.01), 1.0);
  CHECK(within.unobservable.empty());
  const auto beyond = identify(triangle(rows), names, Eigen::Vector2d(1, 0.99), 1.0);
  REQUIRE(beyond.unobservable.size() == 1);
  CHECK(beyond.unobservable[0].parameters == Names{"b"});
  CHECK(beyond.unobservable[0].standard_error == Approx(1.0));
  CHECK(beyond.rank == 2);
  // The noise factor multiplies standard errors.
  CHECK(identify(triangle(rows), names, Eigen::Vector2d(1, 1.01), 1.02).unobservable.size() == 1);
}

TEST_CASE("columns at a small angle are weak below a fiftieth and not above it") {
  // At unit length the singular values are sqrt(1 +- cos t), their ratio tan(t / 2).
  const Names names{"a", "b"};
  for (const bool below : {true, false}) {
    const double t = 2.0 * std::atan(below ? 0.0199 : 0.0201);
    MatrixXd rows = clear_columns(2);
    rows.col(1) = 3.0 * (std::cos(t) * rows.col(0) + std::sin(t) * rows.col(1));
    const auto result = identify(triangle(rows), names, 10.0 * ones(2), 1.0);
    CHECK(result.unobservable.empty());
    REQUIRE(result.weak.size() == (below ? 1 : 0));
    if (!below) continue;
    // The weak functional is |a| xi_a - |b| xi_b with column lengths 100 and 300.
    CHECK(result.weak[0].text == "0.316 a - 0.949 b");
    const double smallest = std::sqrt(1.0 - std::cos(t));
    CHECK(result.weak[0].standard_error ==
          Approx(std::sqrt(2.0) / smallest / std::hypot(100.0, 300.0)).epsilon(1e-6));
    CHECK(result.message().starts_with("a and b are hard to tell apart: 0.316 a - 0.949 b has a"));
  }
}

TEST_CASE("a parameter's unit does not decide whether it is observable") {
  MatrixXd rows = clear_columns(3);
  const Eigen::Vector3d unit(1e9, 1.0, 1e-9);
  const auto result =
      identify(triangle(rows * unit.asDiagonal()), {"a", "b", "c"}, unit.cwiseInverse(), 1.0);
  CHECK(result.message().empty());
  CHECK(result.rank == 3);
}

TEST_CASE(
    "a combination is written at unit length, its first sign positive, small shares left out") {
  const Names names{"a", "b", "c"};
  CHECK(sepcal::combination_text(Eigen::Vector3d(-4, 3, 0), names) == "0.8 a - 0.6 b");
  CHECK(sepcal::combination_text(Eigen::Vector3d(0, 0, -7), names) == "c");
  CHECK(sepcal::combination_text(Eigen::Vector3d(1, 0.009, 0.5), names) == "0.894 a + 0.447 c");
}

TEST_CASE("sparsify turns a mixed basis of coordinate axes back into the axes") {
  MatrixXd mixed = MatrixXd::Zero(5, 2);
  mixed(1, 0) = mixed(1, 1) = mixed(3, 0) = std::sqrt(0.5);
  mixed(3, 1) = -std::sqrt(0.5);
  const MatrixXd sparse = sepcal::sparsify(mixed).cwiseAbs();
  for (Index column = 0; column < 2; ++column) {
    CHECK(sparse.col(column).maxCoeff() == Approx(1.0));
    CHECK(sparse.col(column).sum() == Approx(1.0));
  }
  CHECK(sparse.row(1).sum() == Approx(1.0));
  CHECK(sparse.row(3).sum() == Approx(1.0));
}

}  // namespace identifiability_test
