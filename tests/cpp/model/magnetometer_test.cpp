// SPDX-License-Identifier: BSD-3-Clause
// The magnetometer against a known field (Eqs. B1-B3), its nine-parameter matrix multiplied by
// hand.
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/detail/compiled_models.hpp"

#include <doctest/doctest.h>

#include "dense_reference.hpp"
#include "numerics/decompositions.hpp"
#include "sepcal/fit.hpp"
#include "simulated_records.hpp"

namespace magnetometer_test {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using sepcal::Magnetometer;
using sepcal::Vec;

namespace {

/// C_alpha C_eta C_lambda, multiplied out.
Matrix3d matrix_by_hand(const Vec<double, 6>& xi1, const Vec<double, 6>& xi2) {
  const double ex = xi2[0], ey = xi2[1], ez = xi2[2];
  const double xy = xi2[3], xz = xi2[4], yz = xi2[5];
  Matrix3d C;
  C << 1 + xy * ez - xz * ey, -ez + xy + xz * ex, ey - xy * ex + xz,  //
      xy + ez - yz * ey, -xy * ez + 1 + yz * ex, xy * ey - ex + yz,   //
      xz + yz * ez - ey, -xz * ez + yz + ex, xz * ey - yz * ex + 1;
  C.col(0) *= 1 + xi1[0];
  C.col(1) *= 1 + xi1[1];
  C.col(2) *= 1 + xi1[2];
  return C;
}

}  // namespace

TEST_CASE("A xi1 + b is C_alpha C_eta C_lambda h + n") {
  sepcal::test::Draws draws(21);
  for (int i = 0; i < 50; ++i) {
    const Vec<double, 6> xi1 = 0.3 * draws.normal_matrix(6, 1);
    const Vec<double, 6> xi2 = 0.3 * draws.normal_matrix(6, 1);
    const Vec<double, 3> h = 40 * draws.normal_matrix(3, 1);
    const auto z = Magnetometer{}.at(h, xi2);
    const Vector3d expected = matrix_by_hand(xi1, xi2) * h + xi1.tail<3>();
    CHECK((z.A * xi1 + z.b - expected).norm() < 1e-12 * (1 + h.norm()));
  }
}

TEST_CASE("C_eta is I + [eta x]: entry (3,2) is eta_x (Eq. A2 as it must be read)") {
  Vec<double, 6> xi2;
  xi2 << 0.1, 0.2, 0.3, 0, 0, 0;
  const Matrix3d C = Magnetometer::soft_iron_and_misalignment(xi2);
  const Vector3d h(5, -7, 11);
  const Vector3d eta(0.1, 0.2, 0.3);
  CHECK((C * h - h - eta.cross(h)).norm() < 1e-14);
}

TEST_CASE("the nine parameters of C are identifiable: no direction of them leaves C as it is") {
  const auto entries = [](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    Vec<double, 6> xi1 = Vec<double, 6>::Zero();
    xi1.head<3>() = x.head<3>();
    return matrix_by_hand(xi1, x.tail<6>()).reshaped();
  };
  Eigen::MatrixXd jacobian(9, 9);
  for (int k = 0; k < 9; ++k) {
    const Eigen::VectorXd step = 1e-5 * Eigen::VectorXd::Unit(9, k);
    jacobian.col(k) = (entries(step) - entries(-step)) / 2e-5;
  }
  CHECK(Eigen::FullPivLU<Eigen::MatrixXd>(jacobian).rank() == 9);
}

TEST_CASE("given its noise, the fit is the linear regression of m on h in disguise") {
  const auto flight = sepcal::test::simulate_magnetometer(300);
  sepcal::FitOptions options;
  options.samples = 50;
  options.noise = {{"mx", 0.1}, {"my", 0.2}, {"mz", 0.3}};
  const auto fit = sepcal::fit(*flight.model, flight.record, options);
  CHECK(fit.status == sepcal::FitStatus::converged);

  // [C | n] row by row: each output's own regression, whatever its noise.
  Eigen::MatrixXd regressors(300, 4);
  Eigen::MatrixXd m(300, 3);
  const char* const inputs[] = {"hx", "hy", "hz"};
  const char* const outputs[] = {"mx", "my", "mz"};
  for (int i = 0; i < 3; ++i) {
    regressors.col(i) =
        Eigen::Map<const Eigen::VectorXd>(flight.record.column(inputs[i]).data(), 300);
    m.col(i) = Eigen::Map<const Eigen::VectorXd>(flight.record.column(outputs[i]).data(), 300);
  }
  regressors.col(3).setOnes();
  const Eigen::MatrixXd expected = regressors.colPivHouseholderQr().solve(m).transpose();
  const Vec<double, 6> xi1 = fit.xi1();
  const Vec<double, 6> xi2 = fit.xi2();
  CHECK((matrix_by_hand(xi1, xi2) - expected.leftCols<3>()).norm() < 1e-10);
  CHECK((xi1.tail<3>() - expected.col(3)).norm() < 1e-9);
}

TEST_CASE("the linear fit m = C h + n, split into its factors, is where the minimum is") {
  sepcal::test::Draws draws(22);
  for (int i = 0; i < 20; ++i) {
    const Vec<double, 6> xi1 = 0.1 * draws.normal_matrix(6, 1);
    const Vec<double, 6> xi2 = 0.15 * draws.normal_matrix(6, 1);
    const Eigen::MatrixXd h = 40 * draws.normal_matrix(12, 3);
    Eigen::MatrixXd m = h * matrix_by_hand(xi1, xi2).transpose();
    m.rowwise() += xi1.tail<3>().transpose();
    const Eigen::MatrixXd guess = Magnetometer::guess(h, m);
    REQUIRE(guess.cols() == 1);
    CHECK((guess.col(0) - xi2).norm() < 1e-9);
  }
  // A sensor that reads nothing: C can't be split.
  CHECK(Magnetometer::guess(draws.normal_matrix(12, 3), Eigen::MatrixXd::Zero(12, 3)).cols() == 0);
}

}  // namespace magnetometer_test
