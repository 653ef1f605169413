// SPDX-License-Identifier: BSD-3-Clause
// Losses against their definitions, the scale against bisection of its own equation.
#include "model/loss.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "simulated_records.hpp"

namespace loss_test {

using doctest::Approx;
using Eigen::VectorXd;
using sepcal::Loss;
using sepcal::model::RobustLoss;

namespace {

VectorXd draw_normal(Eigen::Index rows, std::uint64_t seed) {
  return sepcal::test::Draws(seed).normal_matrix(rows, 1);
}

/// sum min(|r| / sigma, c)^2 / N.
double clipped_square(const VectorXd& r, double sigma, double c) {
  return (r / sigma).cwiseAbs().cwiseMin(c).squaredNorm() / static_cast<double>(r.size());
}

}  // namespace

TEST_CASE("what a residual costs") {
  const RobustLoss huber(Loss::huber, 1.5);
  CHECK(huber.cost(1.0) == 1.0);
  CHECK(huber.cost(-2.0) == Approx(2 * 1.5 * 2.0 - 1.5 * 1.5));
  CHECK(huber.influence(-7.0) == Approx(-1.5));
  CHECK(huber.slope(1.4) == 1.0);
  CHECK(huber.slope(1.6) == 0.0);
  const RobustLoss cauchy(Loss::cauchy, 2.0);
  CHECK(cauchy.cost(2.0) == Approx(4.0 * std::log(2.0)));
  CHECK(cauchy.influence(2.0) == Approx(1.0));
  CHECK(RobustLoss(Loss::huber, 0.0).influence(9.0) == Approx(1.345));
  CHECK(RobustLoss(Loss::cauchy, 0.0).cost(2.385) == Approx(2.385 * 2.385 * std::log(2.0)));
}

TEST_CASE("influence and slope are derivatives; cost is concave in s^2 and zero at zero") {
  for (const Loss kind : {Loss::huber, Loss::cauchy}) {
    const RobustLoss loss(kind, 1.7);
    CHECK(loss.cost(0.0) == 0.0);
    for (const double s : {-6.0, -1.2, 0.3, 1.69, 1.71, 25.0}) {
      CAPTURE(s);
      const double h = 1e-5;
      CHECK(loss.influence(s) ==
            Approx((loss.cost(s + h) - loss.cost(s - h)) / (4.0 * h)).epsilon(1e-7));
      CHECK(loss.slope(s) ==
            Approx((loss.influence(s + h) - loss.influence(s - h)) / (2.0 * h)).epsilon(1e-6));
      CHECK(loss.cost(s) >= loss.weight(s) * s * s);
    }
  }
}

TEST_CASE("the scale solves Huber's proposal 2") {
  VectorXd r = 0.3 * draw_normal(20'000, 5);
  r.head(1000).array() += 40.0;
  const double scale = RobustLoss(Loss::huber, 0.0).scale(r);
  // E min(|v|, 1.345)^2 = 0.7102 for a normal v: scipy.integrate.quad.
  CHECK(clipped_square(r, scale, 1.345) == Approx(0.7101645).epsilon(1e-6));
  CHECK(scale == Approx(0.3).epsilon(0.12));  // one in twenty is an outlier of 130 sigma
  CHECK(RobustLoss(Loss::cauchy, 1.0).scale(r) == scale);
  std::ranges::reverse(r);
  CHECK(RobustLoss(Loss::huber, 0.0).scale(r) == Approx(scale).epsilon(1e-12));
}

TEST_CASE("without outliers the scale is the standard deviation, of a wide loss the rms") {
  const VectorXd r = 2.0 * draw_normal(100'000, 6);
  CHECK(RobustLoss(Loss::huber, 0.0).scale(r) == Approx(2.0).epsilon(0.01));
  const double rms = r.norm() / std::sqrt(100'000.0);
  CHECK(RobustLoss(Loss::huber, 40.0).scale(r) == Approx(rms).epsilon(1e-12));
}

TEST_CASE("residuals that are mostly zero have no scale") {
  VectorXd r = VectorXd::Zero(100);
  CHECK(RobustLoss(Loss::huber, 0.0).scale(r) == 0.0);
  r.head(5).setConstant(1.0);
  CHECK(RobustLoss(Loss::huber, 0.0).scale(r) == 0.0);
}

}  // namespace loss_test
