// SPDX-License-Identifier: BSD-3-Clause
// Ellipsoids and spheres through points that lie on them, and points that lie on neither.
#include "flight/probes/ellipsoid.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <vector>

#include "model/soft_iron_and_scale.hpp"
#include "simulated_records.hpp"

namespace ellipsoid_test {

using doctest::Approx;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using namespace sepcal;

namespace {

/// Points as columns.
struct Cloud {
  std::array<std::vector<double>, 3> axes;

  void add(const Vector3d& point) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      axes[axis].push_back(point[static_cast<Eigen::Index>(axis)]);
    }
  }
  probes::Points points() const { return {axes[0], axes[1], axes[2]}; }
};

/// 600 points map(u), u on the unit sphere where `keep` says so.
Cloud make_cloud(
    const std::function<Vector3d(const Vector3d&)>& map,
    const std::function<bool(const Vector3d&)>& keep = [](const Vector3d&) { return true; }) {
  test::Draws draws(8);
  Cloud cloud;
  while (cloud.axes[0].size() < 600) {
    const Vector3d u = Vector3d(draws.normal_matrix(3, 1)).normalized();
    if (keep(u)) cloud.add(map(u));
  }
  return cloud;
}

const Matrix3d root{{52, 3, -1}, {2, 45, 4}, {0, 5, 60}};
const Vector3d centre(120, -80, 33);

}  // namespace

TEST_CASE("an ellipsoid comes back from its points, from a third of it too") {
  const auto on_ellipsoid = [](const Vector3d& u) -> Vector3d { return root * u + centre; };
  for (const double lowest : {-1.0, 1.0 / 3}) {
    const Cloud cloud =
        make_cloud(on_ellipsoid, [lowest](const Vector3d& u) { return u[1] >= lowest; });
    const auto fitted = probes::fit_ellipsoid(cloud.points());
    REQUIRE(fitted);
    CHECK((fitted->centre - centre).norm() < 1e-8);
    CHECK((fitted->shape - root * root.transpose()).norm() < 1e-6);
    CHECK(fitted->radius() == Approx(std::cbrt(root.determinant())).epsilon(1e-8));
  }
}

TEST_CASE("nothing where the points are no ellipsoid, or leave it open") {
  const auto hyperboloid = [](const Vector3d& u) -> Vector3d {
    return {u[0], u[1], std::sqrt(1 + u[0] * u[0] + u[1] * u[1])};
  };
  CHECK_FALSE(sepcal::probes::fit_ellipsoid(make_cloud(hyperboloid).points()));
  const auto circle = [](const Vector3d& u) -> Vector3d {
    return Vector3d(u[0], u[1], 0).normalized() + Vector3d(0, 0, 0.3);
  };
  CHECK_FALSE(sepcal::probes::fit_ellipsoid(make_cloud(circle).points()));
  CHECK_FALSE(sepcal::probes::fit_sphere(make_cloud(circle).points()));
  const auto one_point = [](const Vector3d&) { return centre; };
  CHECK_FALSE(sepcal::probes::fit_ellipsoid(make_cloud(one_point).points()));
  CHECK_FALSE(sepcal::probes::fit_sphere(make_cloud(one_point).points()));
  Cloud eight;
  for (int i = 0; i < 8; ++i) eight.add(root * Vector3d(i & 1, i & 2, i & 4).normalized());
  CHECK_FALSE(sepcal::probes::fit_ellipsoid(eight.points()));
}

TEST_CASE("a sphere comes back from a cap of it") {
  const Cloud cap = make_cloud([](const Vector3d& u) -> Vector3d { return 48 * u + centre; },
                               [](const Vector3d& u) { return u[2] > 0.9; });
  const auto fitted = probes::fit_sphere(cap.points());
  REQUIRE(fitted);
  CHECK((fitted->centre - centre).norm() < 1e-8);
  CHECK(fitted->radius == Approx(48).epsilon(1e-9));
}

TEST_CASE("the box of points") {
  Cloud cloud;
  cloud.add({1, 2, 3});
  cloud.add({-3, 2, 5});
  cloud.add({0, 4, 3.5});
  const probes::PointBox box = probes::box_of(cloud.points());
  CHECK(box.middle == Vector3d(-1, 3, 4));
  CHECK(box.half_width == Vector3d(2, 1, 1));
}

TEST_CASE("coverage: round, one-sided, flat, rough") {
  const auto on_ellipsoid = [](const Vector3d& u) -> Vector3d { return root * u + centre; };
  const probes::Ellipsoid ellipsoid{centre, root * root.transpose()};
  const probes::Coverage round =
      probes::judge_coverage(make_cloud(on_ellipsoid).points(), ellipsoid);
  CHECK(round.roughness < 1e-12);
  CHECK(round.one_sided < 0.15);  // 600 directions: 0.04 rms
  CHECK(round.thinnest == Approx(1.0 / 3).epsilon(0.15));
  const probes::Coverage cap = probes::judge_coverage(
      make_cloud(on_ellipsoid, [](const Vector3d& u) { return u[0] > 0.8; }).points(), ellipsoid);
  CHECK(cap.one_sided == Approx(0.9).epsilon(0.02));  // the mean height of the cap
  CHECK(cap.thinnest < 0.1);
  const probes::Coverage rough = probes::judge_coverage(
      make_cloud([&](const Vector3d& u) -> Vector3d { return 1.25 * root * u + centre; }).points(),
      ellipsoid);
  CHECK(rough.roughness == Approx(0.25).epsilon(1e-9));
  CHECK(probes::Ellipsoid{centre, Vector3d(4, 1, 9).asDiagonal()}.elongation() == Approx(3));
}

TEST_CASE("a shape splits into scale factors and soft iron") {
  test::Draws draws(9);
  for (int i = 0; i < 50; ++i) {
    Vector3d scale;
    Vector3d alpha;
    for (double& value : scale) value = draws.uniform(0.6, 1.4);
    for (double& value : alpha) value = draws.uniform(-0.3, 0.3);
    const Matrix3d soft_iron{
        {1, alpha[0], alpha[1]}, {alpha[0], 1, alpha[2]}, {alpha[1], alpha[2], 1}};
    const Matrix3d C = soft_iron * scale.asDiagonal();
    const auto split = model::split_shape(C * C.transpose());
    REQUIRE(split);
    CHECK((split->scale - scale).norm() < 1e-9);
    CHECK((split->soft_iron - alpha).norm() < 1e-9);
  }
}

}  // namespace ellipsoid_test
