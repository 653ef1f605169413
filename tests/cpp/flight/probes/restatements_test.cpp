// SPDX-License-Identifier: BSD-3-Clause
// Estimates in the forms that people elsewhere write: by hand, and by drawing from the ellipse.
#include "flight/probes/restatements.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "draws.hpp"

namespace restatements_test {

using doctest::Approx;
using sepcal::Fit;
using sepcal::Restatement;
using sepcal::probes::restate_correction;
using sepcal::probes::restate_ratio;
using sepcal::probes::restate_wind;

namespace {

/// Of a wind blowing to (n, e) [m/s], with other parameters about it.
Fit wind_fit(double n, double e, const Eigen::Matrix2d& covariance) {
  Fit fit;
  fit.parameters.resize(3);
  fit.parameters[0].name = "s_va";
  fit.parameters[1].name = "w_n";
  fit.parameters[2].name = "w_e";
  fit.parameters[1].value = n;
  fit.parameters[2].value = e;
  fit.covariance = Eigen::Matrix3d::Identity();
  fit.covariance.bottomRightCorner<2, 2>() = covariance;
  return fit;
}

double number(const Restatement& one, const char* name) { return one.numbers.at(name).at(0); }

}  // namespace

TEST_CASE("a wind blows from where the air comes") {
  const Eigen::Matrix2d certain = Eigen::Matrix2d::Identity() * 1e-4;
  for (const auto& [n, e, from] : {std::tuple{-10.0, 0.0, 0.0}, std::tuple{0.0, -10.0, 90.0},
                                   std::tuple{10.0, 0.0, 180.0}, std::tuple{0.0, 10.0, 270.0}}) {
    const auto wind = restate_wind(wind_fit(n, e, certain));
    REQUIRE(wind);
    CHECK(number(*wind, "from_deg") == Approx(from).epsilon(1e-12));
    CHECK(number(*wind, "speed_mps") == Approx(10.0));
  }
  const auto wind = restate_wind(wind_fit(3.0, 4.0, certain));
  CHECK(wind->sentence.starts_with("from 233 deg, 9.7 kt; 95 % within an ellipse of "));
}

TEST_CASE("the ellipse of a wind holds it in 95 %") {
  Eigen::Matrix2d covariance;
  covariance << 0.5, 0.3, 0.3, 0.4;
  const auto wind = restate_wind(wind_fit(5.0, 1.0, covariance));
  const auto axes = wind->numbers.at("ellipse_mps");
  CHECK(axes[0] > axes[1]);
  const double turn = number(*wind, "ellipse_axis_deg") * std::numbers::pi / 180.0;
  const Eigen::Matrix2d L = covariance.llt().matrixL();
  sepcal::test::Draws draws(3);
  constexpr int count = 20'000;
  int inside = 0;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d off = L * Eigen::Vector2d(draws.normal(), draws.normal());
    const double along = off[0] * std::cos(turn) + off[1] * std::sin(turn);
    const double across = -off[0] * std::sin(turn) + off[1] * std::cos(turn);
    if (std::hypot(along / axes[0], across / axes[1]) < 1.0) ++inside;
  }
  // Four standard deviations of a share of 95 % in so many draws.
  CHECK(std::abs(inside / static_cast<double>(count) - 0.95) <
        4.0 * std::sqrt(0.95 * 0.05 / count));
}

TEST_CASE("a wind without errors has no ellipse, and one that was held none at all") {
  const auto nothing = std::numeric_limits<double>::quiet_NaN();
  const auto wind = restate_wind(wind_fit(3.0, 4.0, Eigen::Matrix2d::Constant(nothing)));
  CHECK(wind->sentence == "from 233 deg, 9.7 kt");
  CHECK(wind->numbers.count("ellipse_mps") == 0);
  Fit held = wind_fit(3.0, 4.0, Eigen::Matrix2d::Identity());
  held.parameters[1].fixed = held.parameters[2].fixed = true;
  CHECK(!restate_wind(held));
}

TEST_CASE("a magnetometer's correction takes a reading back to the field") {
  Eigen::Matrix3d C;
  C << 1.1, 0.02, -0.01, 0.03, 0.9, 0.05, 0.0, -0.04, 1.2;
  const Eigen::Vector3d b(5.0, -7.0, 2.0);
  const auto correction = restate_correction(C, b);
  REQUIRE(correction);
  const auto& A = correction->numbers.at("A");
  const Eigen::Vector3d field(20.0, -1.5, 49.0);
  const Eigen::Vector3d raw = C * field + b;
  for (std::size_t i = 0; i < 3; ++i) {
    double h = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      h += A[3 * i + k] * (raw[static_cast<Eigen::Index>(k)] - correction->numbers.at("b_ut")[k]);
    }
    CHECK(h == Approx(field[static_cast<Eigen::Index>(i)]).epsilon(1e-12));
  }
  CHECK(!restate_correction(Eigen::Matrix3d::Zero(), b));
}

TEST_CASE("an autopilot's ratio is of pressure, which goes with the square of airspeed") {
  const Restatement ratio = restate_ratio(0.05, 0.3);
  CHECK(number(ratio, "factor") == Approx(1.1025));
  CHECK(ratio.sentence == "ARSPD_RATIO times 1.1025; it holds a scale alone, without b_va 0.3 m/s");
}

}  // namespace restatements_test
