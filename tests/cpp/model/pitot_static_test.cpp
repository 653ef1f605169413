// SPDX-License-Identifier: BSD-3-Clause
// The Pitot-static tube: what effects do to it undone one by one, derivatives against differences,
// and a tube at rest.
#include "sepcal/models/pitot_static.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/static_model.hpp"
#include "simulated_records.hpp"

namespace pitot_static_test {

using doctest::Approx;
using sepcal::PitotStatic;
using sepcal::Vec;

namespace {

enum { vn, ve, vd, airspeed_scale, airspeed_bias, pressure_offset, rho };

Vec<double, 7> flying(double north, double east, double down) {
  Vec<double, 7> u = Vec<double, 7>::Zero();
  u[vn] = north;
  u[ve] = east;
  u[vd] = down;
  u[rho] = 1.1;
  return u;
}

double read(const Vec<double, 7>& u, const Vec<double, 3>& wind, double s, double c) {
  const auto z = PitotStatic{}.at(u, wind);
  return z.A(0, 0) * s + z.A(0, 1) * c + z.b[0];
}

/// [A | D | b] of one sample at xi1 = (s, c).
Eigen::MatrixXd tangent(const Vec<double, 7>& u, const Vec<double, 3>& wind, double s, double c) {
  const sepcal::StaticModel<PitotStatic> model({});
  std::vector<const double*> inputs;
  for (const double& value : u) inputs.push_back(&value);
  const Vec<double, 2> xi1(s, c);
  Eigen::MatrixXd rows(1, 6);
  model.evaluate({inputs, 1, 0, true}, wind.data(), xi1.data(), nullptr, rows);
  return rows;
}

}  // namespace

TEST_CASE("the tube reads s_va times the true airspeed, plus c_va") {
  // v - W = (2, 3, 6) has the length 7.
  CHECK(read(flying(12, -7, 6.5), {10, -10, 0.5}, 0.95, -0.6) == Approx(0.95 * 7 - 0.6));
  CHECK(read(flying(7, 0, 0), {0, 0, 0}, 1, 0) == Approx(7).epsilon(1e-13));
}

TEST_CASE("effects act at the tube: the airspeed that it meets comes back as the true one") {
  sepcal::test::Draws draws(5);
  for (int i = 0; i < 100; ++i) {
    const double met = draws.uniform(10, 60);
    Vec<double, 7> u = flying(0, 0, 0);
    u[airspeed_scale] = draws.uniform(-0.2, 0.2);
    u[airspeed_bias] = draws.uniform(-3, 3);
    u[pressure_offset] = draws.uniform(-30, 30);
    u[rho] = draws.uniform(0.4, 1.3);
    // The definitions one after the other: rho V^2 / 2 + s phi, then V + s phi V, then V + s phi.
    double airspeed = std::sqrt(2 * (0.5 * u[rho] * met * met + u[pressure_offset]) / u[rho]);
    airspeed += u[airspeed_scale] * airspeed;
    airspeed += u[airspeed_bias];
    const Eigen::Vector3d direction = Eigen::Vector3d(draws.normal_matrix(3, 1)).normalized();
    const Vec<double, 3> wind = 8 * draws.normal_matrix(3, 1);
    u.head<3>() = wind + airspeed * direction;
    CHECK(read(u, wind, 1.04, -0.7) == Approx(1.04 * met - 0.7).epsilon(1e-12));
  }
}

TEST_CASE("without a logged density it is that of the sea level; ports are shut") {
  const sepcal::Tables tables = sepcal::tables_of<PitotStatic>();
  CHECK(std::isnan(tables.inputs[vd].absent));
  CHECK(tables.inputs[airspeed_scale].absent == 0.0);
  CHECK(tables.inputs[airspeed_bias].absent == 0.0);
  CHECK(tables.inputs[pressure_offset].absent == 0.0);
  CHECK(tables.inputs[rho].absent == 1.225);
  for (const auto& wind : tables.nonlinear) {
    CHECK(wind.lower == -100);
    CHECK(wind.upper == 100);
  }
}

TEST_CASE("derivatives by the wind are those of the values") {
  sepcal::test::Draws draws(6);
  for (int i = 0; i < 30; ++i) {
    Vec<double, 7> u = flying(draws.uniform(10, 50), draws.uniform(-40, 40), draws.uniform(-5, 5));
    u[airspeed_scale] = 0.1;
    u[airspeed_bias] = -2;
    u[pressure_offset] = 20;
    const Vec<double, 3> wind = 5 * draws.normal_matrix(3, 1);
    const Eigen::MatrixXd rows = tangent(u, wind, 0.9, 1.5);
    constexpr double h = 1e-4;
    for (int k = 0; k < 3; ++k) {
      const Vec<double, 3> step = h * Eigen::Vector3d::Unit(k);
      const double slope =
          (read(u, wind + step, 0.9, 1.5) - read(u, wind - step, 0.9, 1.5)) / (2 * h);
      CHECK(rows(0, 2 + k) == Approx(slope).epsilon(1e-7));
    }
  }
}

TEST_CASE("in still air, and where an offset outweighs the air, all is finite") {
  CHECK(tangent(flying(3, -4, 1), {3, -4, 1}, 0.9, 1.5).allFinite());
  Vec<double, 7> u = flying(3, 0, 0);
  u[pressure_offset] = 100;
  CHECK(tangent(u, {0, 0, 0}, 0.9, 1.5).allFinite());
  CHECK(read(u, {0, 0, 0}, 1, 0) < 1e-5);
}

TEST_CASE("the wind from the circles that the ground velocity lies on, whatever scale and bias") {
  const Eigen::Index rows = 60;
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(rows, 7);
  Eigen::MatrixXd z(rows, 1);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double heading = 0.1 * static_cast<double>(i);
    const double airspeed = i % 2 == 0 ? 20.0 : 30.0;
    u(i, vn) = airspeed * std::cos(heading) + 8.0;
    u(i, ve) = airspeed * std::sin(heading) - 5.0;
    z(i, 0) = 1.1 * airspeed;
  }
  const Eigen::MatrixXd guess = PitotStatic::guess(u, z);
  REQUIRE(guess.cols() == 1);
  CHECK(guess(0, 0) == Approx(8.0).epsilon(1e-9));
  CHECK(guess(1, 0) == Approx(-5.0).epsilon(1e-9));
  CHECK(std::abs(guess(2, 0)) < 1e-9);  // a level flight says nothing of it

  z.setConstant(25.0);  // one airspeed: the circle alone
  for (Eigen::Index i = 0; i < rows; ++i) {
    u(i, vn) = 25.0 * std::cos(0.1 * static_cast<double>(i)) + 8.0;
    u(i, ve) = 25.0 * std::sin(0.1 * static_cast<double>(i)) - 5.0;
  }
  CHECK(PitotStatic::guess(u, z)(0, 0) == Approx(8.0).epsilon(1e-9));
  CHECK(PitotStatic::guess(u, z)(1, 0) == Approx(-5.0).epsilon(1e-9));
}

}  // namespace pitot_static_test
