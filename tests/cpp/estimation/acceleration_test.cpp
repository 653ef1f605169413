// SPDX-License-Identifier: BSD-3-Clause
// Fixed points that are known in closed form, and what becomes of turns that lead nowhere.
#include "estimation/acceleration.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace acceleration_test {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using sepcal::estimation::Acceleration;

namespace {

/// log g(R) = M log R + c; how many turns until log R is within 1e-10 of (I - M)^-1 c.
int turns_to_settle(const Matrix3d& M, bool accelerated) {
  const Vector3d c(0.3, -2.0, 1.0);
  const Vector3d end = (Matrix3d::Identity() - M).lu().solve(c);
  VectorXd noise = VectorXd::Constant(3, 2.0);
  Acceleration acceleration;
  for (int turn = 0; turn < 1000; ++turn) {
    const Vector3d log_noise = noise.array().log();
    if ((log_noise - end).cwiseAbs().maxCoeff() < 1e-10) return turn;
    const VectorXd found = Vector3d(M * log_noise + c).array().exp();
    noise = accelerated ? acceleration.next(noise, found) : found;
  }
  return 1000;
}

}  // namespace

TEST_CASE("what shrinks slowly settles in a few turns more than there are outputs") {
  Matrix3d M;
  M << 0.5, 0.2, 0.1, 0.1, 0.6, 0.2, 0.05, 0.1, 0.7;  // eigenvalues 0.40, 0.54, 0.86
  CHECK(turns_to_settle(M, false) > 150);
  CHECK(turns_to_settle(M, true) < 15);
}

TEST_CASE("what settles fast does so by itself") {
  const VectorXd tried = VectorXd::Constant(2, 1.0);
  const VectorXd found = VectorXd::Constant(2, 1.5);
  Acceleration acceleration;
  CHECK(acceleration.next(tried, found) == found);
  CHECK(acceleration.next(found, 1.1 * found) == 1.1 * found);
}

TEST_CASE("turns that do not shrink, or are not finite, are followed as they are") {
  Acceleration acceleration;
  VectorXd noise = VectorXd::Constant(1, 1.0);
  for (int turn = 0; turn < 6; ++turn) {
    const VectorXd found = noise.cwiseAbs2() * 1.5;  // runs away
    CHECK(acceleration.next(noise, found) == found);
    noise = found;
  }
  const VectorXd broken = VectorXd::Constant(1, std::numeric_limits<double>::quiet_NaN());
  CHECK(std::isnan(acceleration.next(noise, broken)[0]));
}

}  // namespace acceleration_test
