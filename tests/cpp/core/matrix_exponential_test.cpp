// SPDX-License-Identifier: BSD-3-Clause
// exp(A) against closed forms; through dual numbers against differences.
#include "sepcal/states/matrix_exponential.hpp"

#include <ceres/jet.h>
#include <doctest/doctest.h>

#include <Eigen/LU>

#include "draws.hpp"

namespace matrix_exponential_test {

using sepcal::matrix_exponential;

TEST_CASE("a rotation, a nilpotent and a diagonal matrix") {
  for (const double angle : {0.0, 1e-9, 0.3, 2.0, 40.0}) {
    Eigen::Matrix2d A;
    A << 0.0, -angle, angle, 0.0;
    Eigen::Matrix2d expected;
    expected << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    CHECK((matrix_exponential(A) - expected).norm() < 1e-15 * (2.0 + 4.0 * angle));
  }
  Eigen::Matrix3d N = Eigen::Matrix3d::Zero();
  N(0, 1) = 3.0;
  N(1, 2) = -2.0;
  const Eigen::Matrix3d expected = Eigen::Matrix3d::Identity() + N + 0.5 * N * N;
  CHECK((matrix_exponential(N) - expected).norm() < 1e-14);
  const Eigen::Vector3d rates(-30.0, 0.5, 4.0);
  const Eigen::Matrix3d E = matrix_exponential<double, 3>(rates.asDiagonal());
  for (int k = 0; k < 3; ++k) CHECK(E(k, k) == doctest::Approx(std::exp(rates[k])).epsilon(1e-13));
}

TEST_CASE("Moler and Van Loan's matrix, whose series cancels") {
  Eigen::Matrix2d A;
  A << -49.0, 24.0, -64.0, 31.0;  // S diag(-1, -17) S^-1
  Eigen::Matrix2d S;
  S << 1.0, 3.0, 2.0, 4.0;
  const Eigen::Matrix2d expected =
      S * Eigen::Vector2d(std::exp(-1.0), std::exp(-17.0)).asDiagonal() * S.inverse();
  CHECK((matrix_exponential(A) - expected).norm() < 1e-12);
}

TEST_CASE("a stiff matrix of ten states: eigenvalues from -1000 to 1") {
  sepcal::test::Draws draws(1);
  constexpr int n = 10;
  using Matrix = Eigen::Matrix<double, n, n>;
  const Matrix S = Matrix::Identity() + 0.1 * Matrix(draws.normal_matrix(n, n));
  const Eigen::Vector<double, n> rates = Eigen::Vector<double, n>::LinSpaced(n, -1000.0, 1.0);
  const Matrix A = S * rates.asDiagonal() * S.inverse();
  const Matrix expected = S * rates.array().exp().matrix().asDiagonal() * S.inverse();
  CHECK((matrix_exponential(A) - expected).norm() < 1e-11 * expected.norm());
}

TEST_CASE("dual numbers pass: the derivative is that of differences") {
  using Jet = ceres::Jet<double, 1>;
  const auto matrix = [](auto p) {
    Eigen::Matrix<decltype(p), 2, 2> A;
    A << -p, p * p, 3.0 * p, sin(p);
    return A;
  };
  const auto E = matrix_exponential(matrix(Jet(0.7, 0)));
  const double h = 1e-5;
  const Eigen::Matrix2d slope =
      (matrix_exponential(matrix(0.7 + h)) - matrix_exponential(matrix(0.7 - h))) / (2.0 * h);
  for (int k = 0; k < 4; ++k) CHECK(E(k).v[0] == doctest::Approx(slope(k)).epsilon(1e-8));
}

TEST_CASE("what is not finite stays so, and huge is no loop without end") {
  for (const double value : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e305}) {
    Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
    A(1, 0) = value;
    A(0, 1) = value;
    CHECK_FALSE(matrix_exponential(A).allFinite());
  }
}

TEST_CASE("units of the states cost no digits") {
  Eigen::Matrix3d A;
  A << -0.5, 1.0, 0.2, -4.0, -0.3, 0.1, 0.3, 0.2, -1.0;
  const Eigen::Matrix3d expected = matrix_exponential(A);
  for (const double unit : {1e6, 1e12}) {
    const Eigen::Vector3d units(unit, 1.0, 1.0 / unit);
    const Eigen::Matrix3d E = matrix_exponential(
        Eigen::Matrix3d(units.asDiagonal() * A * units.cwiseInverse().asDiagonal()));
    const Eigen::Matrix3d back = units.cwiseInverse().asDiagonal() * E * units.asDiagonal();
    CHECK((back - expected).norm() < 1e-13 * expected.norm());
  }
}

}  // namespace matrix_exponential_test
