// SPDX-License-Identifier: BSD-3-Clause
// The boom with vanes against air whose components are known, and its slopes against differences.
#include "sepcal/models/vane_boom.hpp"
#include "sepcal/detail/compiled_models.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "draws.hpp"

namespace vane_boom_test {

using Eigen::Vector3d;
using sepcal::VaneBoom;
using sepcal::Vec;
using sepcal::test::Draws;

namespace {

using Inputs = Vec<double, 13>;
using Five = Vec<double, 5>;

/// A boom that meets the air with these components [m/s] along its axes.
Inputs read_air(const Vector3d& air) {
  Inputs u = Inputs::Zero();
  u[6] = air.norm();
  u[7] = std::atan2(air[2], air[0]);
  u[8] = std::atan2(air[1], air[0]);
  u[9] = 1.1;
  return u;
}

Inputs draw_inputs(Draws& draws) {
  Inputs u;
  u << draws.uniform(-1, 1), draws.uniform(-1, 1), draws.uniform(-3, 3), draws.uniform(-2, 2),
      draws.uniform(-2, 2), draws.uniform(-2, 2), draws.uniform(8, 60), draws.uniform(-0.5, 0.5),
      draws.uniform(-0.5, 0.5), draws.uniform(0.8, 1.3), draws.uniform(-20, 20),
      draws.uniform(-0.1, 0.1), draws.uniform(-0.1, 0.1);
  return u;
}

}  // namespace

TEST_CASE("vanes and tube give back the air that they met") {
  Draws draws(21);
  const VaneBoom boom;
  for (int i = 0; i < 100; ++i) {
    const Vector3d air(draws.uniform(2, 60), draws.uniform(-40, 40), draws.uniform(-40, 40));
    const auto z = boom.at(read_air(air), Five(Five::Zero()));
    CHECK((z.b - air).norm() < 1e-12 * air.norm());
    CHECK((z.A.col(0) - air).norm() < 1e-12 * air.norm());     // lambda_va
    CHECK((z.A.col(1) - air.normalized()).norm() < 1e-12);     // b_va
    CHECK(z.A.rightCols<3>() == Eigen::Matrix3d::Identity());  // the wind
  }
}

TEST_CASE("attitude, lever arm and the boom's rotation are those of rotations put together") {
  Draws draws(22);
  const Vector3d arm(1.2, -0.1, 0.05);
  const VaneBoom boom{arm};
  for (int i = 0; i < 100; ++i) {
    const Vector3d air(draws.uniform(10, 60), draws.uniform(-9, 9), draws.uniform(-9, 9));
    Inputs u = read_air(air);
    u.head<6>() = draws.normal_matrix(6, 1);
    Five xi2 = Five::Zero();
    xi2[4] = draws.uniform(-0.2, 0.2);
    const Eigen::Matrix3d C =
        (Eigen::AngleAxisd(u[2], Vector3d::UnitZ()) * Eigen::AngleAxisd(u[1], Vector3d::UnitY()) *
         Eigen::AngleAxisd(u[0], Vector3d::UnitX()))
            .toRotationMatrix();
    const Vector3d in_body = Eigen::AngleAxisd(-xi2[4], Vector3d::UnitX()) * air;
    const Vector3d expected = C * (in_body - u.segment<3>(3).cross(arm));
    CHECK((boom.at(u, xi2).b - expected).norm() < 1e-12 * air.norm());
  }
}

TEST_CASE("a port joins the impact pressure, or the angle as read") {
  const VaneBoom boom;
  Inputs u = read_air({20, 1, 2});
  u[10] = 30.0;
  u[11] = 0.02;
  u[12] = -0.03;
  Inputs instead = u;
  instead.tail<3>().setZero();
  const double impact = 0.5 * u[9] * u[6] * u[6] + 30.0;
  instead[6] = std::sqrt(2 * impact / u[9]);
  instead[7] += 0.02;
  instead[8] -= 0.03;
  const Five xi2(0.1, 0.02, -0.1, 0.01, 0.05);
  const auto with = boom.at(u, xi2);
  const auto without = boom.at(instead, xi2);
  CHECK((with.b - without.b).norm() < 1e-13 * without.b.norm());
  CHECK((with.A - without.A).norm() < 1e-13 * without.A.norm());
}

TEST_CASE("slopes by hand are those of differences, far from the axis too") {
  Draws draws(23);
  const VaneBoom boom{{0.8, 0.1, -0.2}};
  for (int i = 0; i < 200; ++i) {
    const Inputs u = draw_inputs(draws);
    const Five xi1 = draws.normal_matrix(5, 1);
    const Five xi2 = 0.2 * draws.normal_matrix(5, 1);
    const auto prepared = boom.prepare<double>(u);
    const auto slopes = VaneBoom::tangent(prepared, VaneBoom::settle<double>(xi2), xi1);
    const auto predict = [&](const Five& at) -> Vector3d {
      const auto z = boom.at(u, at);
      return z.A * xi1 + z.b;
    };
    CHECK((slopes.z.b - boom.at(u, xi2).b).norm() == 0.0);
    for (int k = 0; k < 5; ++k) {
      const Five step = 1e-4 * Five::Unit(k);
      // Fourth order: what is left is 1e-16 of the step's power, and rounding.
      const Vector3d expected = (8.0 * (predict(xi2 + step) - predict(xi2 - step)) -
                                 predict(xi2 + 2 * step) + predict(xi2 - 2 * step)) /
                                12e-4;
      CHECK((slopes.D.col(k) - expected).norm() < 1e-8 * (1.0 + expected.norm()));
    }
  }
}

}  // namespace vane_boom_test
