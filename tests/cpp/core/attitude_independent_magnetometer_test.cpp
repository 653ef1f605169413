// SPDX-License-Identifier: BSD-3-Clause
// The field's strength alone: the true sensor has no residual whichever way it is turned, mu is
// what noise adds to |y|, the residual is a distance in the readings' own space.
#include "sepcal/models/attitude_independent_magnetometer.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/static_model.hpp"
#include "simulated_records.hpp"

namespace attitude_independent_magnetometer_test {

using doctest::Approx;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using sepcal::AttitudeIndependentMagnetometer;
using sepcal::Vec;

namespace {

constexpr double strength = 48.0;

const Vec<double, 9> xi2{{0.08, -0.05, 0.12, 0.03, -0.02, 0.05, 12, -8, 20}};

/// C_alpha C_lambda multiplied out.
Matrix3d matrix_by_hand() {
  return Matrix3d{{1.08, 0.03 * 0.95, -0.02 * 1.12},
                  {0.03 * 1.08, 0.95, 0.05 * 1.12},
                  {-0.02 * 1.08, 0.05 * 0.95, 1.12}};
}

Vector3d draw_direction(sepcal::test::Draws& draws) {
  return Vector3d(draws.normal_matrix(3, 1)).normalized();
}

Vec<double, 8> reading(const Vector3d& m) {
  Vec<double, 8> u = Vec<double, 8>::Zero();
  u.head<3>() = m;
  return u;
}

/// z - b: z is zero.
double residual(const Vector3d& m, double noise = 0.0, const Vec<double, 9>& x = xi2) {
  return -AttitudeIndependentMagnetometer{strength, noise}.at(reading(m), x).b[0];
}

}  // namespace

TEST_CASE("a true sensor has no residual, whichever way it is turned in its case") {
  sepcal::test::Draws draws(31);
  const Matrix3d turn = Eigen::AngleAxisd(0.7, draw_direction(draws)).toRotationMatrix();
  for (int i = 0; i < 100; ++i) {
    const Vector3d h = strength * draw_direction(draws);
    CHECK(std::abs(residual(matrix_by_hand() * h + xi2.tail<3>())) < 1e-12);
    CHECK(std::abs(residual(matrix_by_hand() * turn * h + xi2.tail<3>())) < 1e-12);
  }
}

TEST_CASE("the residual is a small reading error's part across the ellipsoid") {
  sepcal::test::Draws draws(32);
  const Matrix3d C = matrix_by_hand();
  for (int i = 0; i < 100; ++i) {
    const Vector3d u = draw_direction(draws);
    const Vector3d normal = C.transpose().inverse() * u;
    const Vector3d error = 1e-5 * draw_direction(draws);
    const double across = error.dot(normal.normalized());
    CHECK(residual(C * strength * u + xi2.tail<3>() + error) == Approx(across).epsilon(1e-4));
  }
}

TEST_CASE("mu is what noise adds to |y| on average: Gauss-Hermite quadrature of E|y + C^-1 e|") {
  constexpr double sigma = 0.6;
  // Three points a direction are exact to the fifth power of e.
  constexpr double points[] = {-1.7320508075688772, 0.0, 1.7320508075688772};
  constexpr double weights[] = {1.0 / 6, 2.0 / 3, 1.0 / 6};
  sepcal::test::Draws draws(33);
  const Matrix3d G = matrix_by_hand().inverse();
  for (int i = 0; i < 20; ++i) {
    const Vector3d y = strength * draw_direction(draws);
    double mean = 0.0;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        for (int c = 0; c < 3; ++c) {
          const Vector3d e = sigma * Vector3d(points[a], points[b], points[c]);
          mean += weights[a] * weights[b] * weights[c] * (y + G * e).norm();
        }
      }
    }
    const Vector3d m = matrix_by_hand() * y + xi2.tail<3>();
    const double by_mu = residual(m, sigma) - residual(m);
    const double gain = (G.transpose() * y.normalized()).norm();
    CHECK(by_mu * gain == Approx(-(mean - strength)).epsilon(1e-3));  // next: (sigma / F)^2
  }
}

TEST_CASE("ports add to the diagonal of C") {
  Vec<double, 8> u = reading({30, -25, 41});
  u[3] = 0.01;
  u[4] = 0.02;
  u[5] = -0.03;
  u[6] = 0.04;
  Matrix3d C = matrix_by_hand();
  C.diagonal() += Vector3d(0.03, -0.02, 0.05);
  const Vector3d y = C.inverse() * (u.head<3>() - xi2.tail<3>());
  const double gain = (C.transpose().inverse() * y.normalized()).norm();
  const double at = AttitudeIndependentMagnetometer{strength, 0.0}.at(u, xi2).b[0];
  CHECK(-at == Approx((y.norm() - strength) / gain).epsilon(1e-12));
  const sepcal::Tables tables = sepcal::tables_of<AttitudeIndependentMagnetometer>();
  for (std::size_t i = 3; i < 8; ++i) CHECK(tables.inputs[i].absent == 0.0);
}

TEST_CASE("a field that has changed by so much is a field of that strength") {
  Vec<double, 8> u = reading({30, -25, 41});
  const double plain = AttitudeIndependentMagnetometer{strength - 2.5, 0.8}.at(u, xi2).b[0];
  u[7] = -2.5;
  const double changed = AttitudeIndependentMagnetometer{strength, 0.8}.at(u, xi2).b[0];
  CHECK(changed == Approx(plain).epsilon(1e-12));
  u[7] = 1.0;
  CHECK(std::abs(AttitudeIndependentMagnetometer{strength, 0.8}.at(u, xi2).b[0] - changed) > 0.1);
}

TEST_CASE("derivatives are those of the values, with noise too") {
  const sepcal::StaticModel<AttitudeIndependentMagnetometer> model({strength, 0.8});
  sepcal::test::Draws draws(34);
  for (int i = 0; i < 30; ++i) {
    const Vec<double, 8> u = reading(50 * draws.normal_matrix(3, 1));
    std::vector<const double*> inputs;
    for (const double& value : u) inputs.push_back(&value);
    Eigen::MatrixXd rows(1, 10);
    const double none = 0.0;
    model.evaluate({inputs, 1, 0, true}, xi2.data(), &none, nullptr, rows);
    for (int k = 0; k < 9; ++k) {
      const double h = k < 6 ? 1e-5 : 1e-4;
      const Vec<double, 9> step = h * Vec<double, 9>::Unit(k);
      const Vector3d m = u.head<3>();
      const double slope = -(residual(m, 0.8, xi2 + step) - residual(m, 0.8, xi2 - step)) / (2 * h);
      CHECK(rows(0, k) == Approx(slope).epsilon(1e-6).scale(1));
    }
  }
}

TEST_CASE("a reading of n itself, which has no direction, is finite") {
  const sepcal::StaticModel<AttitudeIndependentMagnetometer> model({strength, 0.8});
  const Vec<double, 8> u = reading(xi2.tail<3>());
  std::vector<const double*> inputs;
  for (const double& value : u) inputs.push_back(&value);
  Eigen::MatrixXd rows(1, 10);
  const double none = 0.0;
  model.evaluate({inputs, 1, 0, true}, xi2.data(), &none, nullptr, rows);
  CHECK(rows.allFinite());
}

}  // namespace attitude_independent_magnetometer_test
