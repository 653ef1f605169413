// SPDX-License-Identifier: BSD-3-Clause
// The five-hole probe against Eqs. 36-41 written out entry by entry.
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/detail/compiled_models.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "simulated_records.hpp"

namespace five_hole_probe_test {

using sepcal::FiveHoleProbe;
using sepcal::Vec;

namespace {

using Array3 = std::array<double, 3>;
using Array33 = std::array<Array3, 3>;

Array3 times(const Array33& M, const Array3& v) {
  Array3 result{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) result[i] += M[i][j] * v[j];
  }
  return result;
}

/// Eq. 39, its entry (1,2) with cos(psi).
Array33 attitude(double phi, double theta, double psi) {
  const double c1 = std::cos(phi), s1 = std::sin(phi), c2 = std::cos(theta), s2 = std::sin(theta);
  const double c3 = std::cos(psi), s3 = std::sin(psi);
  return {{{c2 * c3, s1 * s2 * c3 - c1 * s3, c1 * s2 * c3 + s1 * s3},
           {c2 * s3, s1 * s2 * s3 + c1 * c3, c1 * s2 * s3 - s1 * c3},
           {-s2, s1 * c2, c1 * c2}}};
}

struct Sample {
  double phi, theta, psi, p, q, r, pt, ps, dpa, dpb, rho;
};

/// Eq. 37: inertial velocity from a reading and the ten parameters.
Array3 velocity(const Sample& u, const Vec<double, 5>& xi1, const Vec<double, 5>& xi2,
                double k_alpha, double k_beta, const Array3& arm) {
  const double alpha = (1 + xi2[0]) * u.dpa / (k_alpha * (u.pt - u.ps)) + xi2[1];
  const double beta = (1 + xi2[2]) * u.dpb / (k_beta * (u.pt - u.ps)) + xi2[3];
  const double airspeed = (1 + xi1[0]) * std::sqrt(2 * (u.pt - u.ps) / u.rho) + xi1[1];
  const Array3 sensor{airspeed * std::cos(alpha) * std::cos(beta), airspeed * std::sin(beta),
                      airspeed * std::sin(alpha) * std::cos(beta)};
  const double ce = std::cos(xi2[4]), se = std::sin(xi2[4]);
  const Array33 mount{{{1, 0, 0}, {0, ce, se}, {0, -se, ce}}};  // Eq. 38
  const Array33 rate_cross{{{0, -u.r, u.q}, {u.r, 0, -u.p}, {-u.q, u.p, 0}}};
  Array3 body = times(mount, sensor);
  const Array3 turning = times(rate_cross, arm);
  for (std::size_t i = 0; i < 3; ++i) body[i] -= turning[i];
  Array3 ned = times(attitude(u.phi, u.theta, u.psi), body);
  for (std::size_t i = 0; i < 3; ++i) ned[i] += xi1[static_cast<int>(i) + 2];
  return ned;
}

}  // namespace

TEST_CASE("A xi1 + b is the wind triangle of Eqs. 36-41 at any reading and any parameters") {
  sepcal::test::Draws draws(11);
  const FiveHoleProbe probe{4.5, 3.8, {0.35, -0.2, 0.1}};
  for (int i = 0; i < 100; ++i) {
    const Sample s{
        draws.uniform(-1, 1),        draws.uniform(-1, 1),        draws.uniform(-3, 3),
        draws.uniform(-2, 2),        draws.uniform(-2, 2),        draws.uniform(-2, 2),
        draws.uniform(9.6e4, 9.7e4), draws.uniform(9.4e4, 9.5e4), draws.uniform(-900, 900),
        draws.uniform(-900, 900),    draws.uniform(0.8, 1.3)};
    Vec<double, 14> u;
    u << s.phi, s.theta, s.psi, s.p, s.q, s.r, s.pt, s.ps, s.dpa, s.dpb, s.rho, 0, 0, 0;
    const Vec<double, 5> xi1 = draws.normal_matrix(5, 1);
    const Vec<double, 5> xi2 = 0.2 * draws.normal_matrix(5, 1);
    const auto z = probe.at(u, xi2);
    const Vec<double, 3> predicted = z.A * xi1 + z.b;
    const Array3 expected = velocity(s, xi1, xi2, 4.5, 3.8, {0.35, -0.2, 0.1});
    for (int j = 0; j < 3; ++j) {
      CHECK(predicted[j] == doctest::Approx(expected[static_cast<std::size_t>(j)]).epsilon(1e-12));
    }
  }
}

TEST_CASE("a level probe without flow angles reads its airspeed northward") {
  const FiveHoleProbe probe{4.5, 4.5};
  Vec<double, 14> u = Vec<double, 14>::Zero();
  u[6] = 95'000 + 0.5 * 1.25 * 400;  // 20 m/s
  u[7] = 95'000;
  u[10] = 1.25;
  const auto z = probe.at(u, Vec<double, 5>(Vec<double, 5>::Zero()));
  CHECK((z.b - Vec<double, 3>(20, 0, 0)).norm() < 1e-12);
  CHECK((z.A.col(0) - Vec<double, 3>(20, 0, 0)).norm() < 1e-12);  // lambda_va
  CHECK((z.A.col(1) - Vec<double, 3>(1, 0, 0)).norm() < 1e-15);   // b_va
  CHECK(z.A.rightCols<3>() == Eigen::Matrix3d::Identity());       // the wind
}

TEST_CASE("alpha is positive nose up, beta with the air along the right wing") {
  const FiveHoleProbe probe{4.5, 4.5};
  Vec<double, 14> u = Vec<double, 14>::Zero();
  u[6] = 95'250;
  u[7] = 95'000;
  u[10] = 1.25;
  u[8] = 4.5 * 250 * 0.1;  // alpha = 0.1
  const Vec<double, 5> none = Vec<double, 5>::Zero();
  CHECK(probe.at(u, none).b[2] == doctest::Approx(20 * std::sin(0.1)));
  u[8] = 0;
  u[9] = 4.5 * 250 * 0.1;  // beta = 0.1
  CHECK(probe.at(u, none).b[1] == doctest::Approx(20 * std::sin(0.1)));
}

TEST_CASE("the ports join the pressure that the airspeed is read from, and the angles as read") {
  sepcal::test::Draws draws(12);
  const FiveHoleProbe probe{4.5, 3.8, {0.35, -0.2, 0.1}};
  for (int i = 0; i < 20; ++i) {
    const double pressure = draws.uniform(200, 900);
    const double alpha = draws.uniform(-0.2, 0.2);
    const double beta = draws.uniform(-0.2, 0.2);
    const double offset = draws.uniform(-100, 100);
    const double more_alpha = draws.uniform(-0.1, 0.1);
    const double more_beta = draws.uniform(-0.1, 0.1);
    // The rates, the attitude and the density are the same on both sides.
    Vec<double, 14> with_ports;
    with_ports << 0.3, -0.2, 1.0, 0.1, -0.2, 0.3, 95'000 + pressure, 95'000, 4.5 * pressure * alpha,
        3.8 * pressure * beta, 1.1, offset, more_alpha, more_beta;
    const double moved = pressure + offset;
    Vec<double, 14> instead;
    instead << 0.3, -0.2, 1.0, 0.1, -0.2, 0.3, 95'000 + moved, 95'000,
        4.5 * moved * (alpha + more_alpha), 3.8 * moved * (beta + more_beta), 1.1, 0, 0, 0;
    const Vec<double, 5> xi2 = 0.2 * draws.normal_matrix(5, 1);
    const auto a = probe.at(with_ports, xi2);
    const auto b = probe.at(instead, xi2);
    CHECK((a.A - b.A).norm() < 1e-12 * b.A.norm());
    CHECK((a.b - b.b).norm() < 1e-12 * b.b.norm());
  }
}

}  // namespace five_hole_probe_test
