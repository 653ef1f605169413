// SPDX-License-Identifier: BSD-3-Clause
// Products of tall matrices against Eigen's, element by element.
#include "numerics/tall_products.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "draws.hpp"

namespace tall_products_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace sepcal;
using namespace sepcal::test;

namespace {

bool agree(const MatrixXd& product, const MatrixXd& expected) {
  return (product - expected).norm() <= 1e-13 * expected.norm();
}

}  // namespace

TEST_CASE("products are added, whatever the number of rows and columns") {
  Draws draws(7);
  for (const Index rows : {0, 1, 7, 8, 511, 513, 1030}) {
    for (const Index p : {1, 2, 3, 4, 5, 9}) {
      for (const Index q : {1, 2, 3, 8}) {
        CAPTURE(rows);
        CAPTURE(p);
        CAPTURE(q);
        // Columns of larger matrices: they don't follow each other.
        const MatrixXd all = draws.normal_matrix(rows + 3, p + q);
        const auto A = all.middleRows(2, rows).leftCols(p);
        const auto B = all.middleRows(2, rows).rightCols(q);
        MatrixXd sum = MatrixXd::Ones(p, q);
        numerics::add_transposed_product(A, B, sum);
        CHECK(agree(sum, MatrixXd::Ones(p, q) + A.transpose() * B));
        MatrixXd square = MatrixXd::Ones(p, p);
        numerics::add_square(A, square);
        CHECK(agree(square, MatrixXd::Ones(p, p) + A.transpose() * A));
        const MatrixXd C = draws.normal_matrix(p, q);
        MatrixXd Y = MatrixXd::Ones(rows + 2, q);
        numerics::add_product(A, C, Y.middleRows(1, rows));
        CHECK(agree(Y.middleRows(1, rows), MatrixXd::Ones(rows, q) + A * C));
        CHECK(Y.row(0).isOnes());
        CHECK(Y.row(rows + 1).isOnes());
      }
    }
  }
}

TEST_CASE("no columns leave everything as it is; what is no number stays so") {
  MatrixXd Y = MatrixXd::Ones(20, 2);
  numerics::add_product(MatrixXd(20, 0), MatrixXd(0, 2), Y);
  CHECK(Y.isOnes());
  VectorXd a = VectorXd::Ones(20);
  a[11] = std::numeric_limits<double>::quiet_NaN();
  MatrixXd sum = MatrixXd::Zero(1, 1);
  numerics::add_square(a, sum);
  CHECK(std::isnan(sum(0, 0)));
}

}  // namespace tall_products_test
