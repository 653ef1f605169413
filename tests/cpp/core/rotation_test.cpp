// SPDX-License-Identifier: BSD-3-Clause
// Body axes to north-east-down (Eq. 39).
#include "sepcal/detail/rotation.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "simulated_records.hpp"

namespace rotation_test {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using sepcal::body_to_ned;

namespace {

constexpr double right_angle = 0.5 * std::numbers::pi;

bool same(const Vector3d& a, const Vector3d& b) { return (a - b).norm() < 1e-15; }

}  // namespace

TEST_CASE("level and northbound, body axes are north, east and down") {
  CHECK(body_to_ned(0.0, 0.0, 0.0) == Matrix3d::Identity());
}

TEST_CASE("one right angle about one axis takes each body axis where a pilot expects it") {
  const Matrix3d east = body_to_ned(0.0, 0.0, right_angle);
  CHECK(same(east * Vector3d::UnitX(), Vector3d::UnitY()));   // the nose points east,
  CHECK(same(east * Vector3d::UnitY(), -Vector3d::UnitX()));  // the right wing south
  const Matrix3d climb = body_to_ned(0.0, right_angle, 0.0);
  CHECK(same(climb * Vector3d::UnitX(), -Vector3d::UnitZ()));  // the nose points up
  const Matrix3d bank = body_to_ned(right_angle, 0.0, 0.0);
  CHECK(same(bank * Vector3d::UnitY(), Vector3d::UnitZ()));  // the right wing points down
}

TEST_CASE("it is yaw, then pitch, then roll, and a rotation, at any angles") {
  sepcal::test::Draws draws(5);
  for (int i = 0; i < 50; ++i) {
    const double roll = draws.uniform(-4, 4);
    const double pitch = draws.uniform(-4, 4);
    const double yaw = draws.uniform(-7, 7);
    const Matrix3d C = body_to_ned(roll, pitch, yaw);
    const Matrix3d product =
        (AngleAxisd(yaw, Vector3d::UnitZ()) * AngleAxisd(pitch, Vector3d::UnitY()) *
         AngleAxisd(roll, Vector3d::UnitX()))
            .toRotationMatrix();
    CHECK((C - product).norm() < 1e-14);
    CHECK((C * C.transpose() - Matrix3d::Identity()).norm() < 1e-14);
    CHECK(C.determinant() == doctest::Approx(1.0).epsilon(1e-14));
  }
}

}  // namespace rotation_test
