// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/normal_equations.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>

namespace normal_equations_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::numerics::explained_squares;
using sepcal::numerics::ExplainedSquares;

namespace {

const VectorXd y{{3.0, 4.0, 12.0}};  // 169 = 25 in the plane of the first two axes + 144

ExplainedSquares explained_by(const MatrixXd& G) {
  return explained_squares(G.transpose() * G, G.transpose() * y, G.colwise().norm().transpose());
}

}  // namespace

TEST_CASE("columns explain what lies in their span, whatever their lengths") {
  MatrixXd G(3, 2);
  G << 1.0, 1e6,  //
      1.0, -1e6,  //
      0.0, 0.0;
  CHECK(explained_by(G).square == doctest::Approx(25.0));
  CHECK(explained_by(G).directions == 2);
}

TEST_CASE("a direction counts once, a column of zeros for nothing") {
  MatrixXd G = MatrixXd::Zero(3, 3);
  G.row(2).head(2).setConstant(2.0);
  CHECK(explained_by(G).square == doctest::Approx(144.0));
  CHECK(explained_by(G).directions == 1);
}

TEST_CASE("no column explains anything") {
  CHECK(explained_by(MatrixXd(3, 0)).square == 0.0);
  CHECK(explained_by(MatrixXd(3, 0)).directions == 0);
}

}  // namespace normal_equations_test
