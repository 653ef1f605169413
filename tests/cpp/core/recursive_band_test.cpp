// SPDX-License-Identifier: BSD-3-Clause
// Equation error over a band, row by row: exact where rows are, and as often right as it says.
#include "sepcal/frequency/recursive_band.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>

#include "draws.hpp"

namespace recursive_band_test {

using Eigen::Dynamic;
using Eigen::VectorXd;
using sepcal::BandEstimate;
using sepcal::RecursiveBand;
using sepcal::RecursiveBandOptions;
using sepcal::test::Draws;

namespace {

constexpr double dt = 0.02;  // s

VectorXd frequencies(Eigen::Index count = 39) {
  return VectorXd::LinSpaced(count, 0.1, 0.1 + 0.05 * static_cast<double>(count - 1));
}

/// Sines that no multiple of the band's frequencies meets.
double waves(double t, double phase) {
  return std::sin(2.3 * t + phase) + 0.6 * std::sin(5.1 * t + 2.0 * phase) +
         0.3 * std::cos(9.7 * t - phase);
}

}  // namespace

TEST_CASE("rows without noise tell regressors and the constant, through a large trim and a drift") {
  RecursiveBand<3, 39> fixed(frequencies());
  RecursiveBand<Dynamic, Dynamic> dynamic(frequencies(), {}, 3);
  const Eigen::Vector3d truth(2.0, -3.0, 0.5);
  for (int k = 0; k < 1500; ++k) {
    const double t = 100.0 + dt * k + 0.004 * std::sin(7.0 * k);  // clocks jitter
    const Eigen::Vector3d row(40.0 + waves(t, 0.3), waves(t, 1.9) + 0.1 * t, 1.0);
    CHECK(fixed.absorb(t, row, row.dot(truth)));
    CHECK(dynamic.absorb(t, row, row.dot(truth)));
  }
  const BandEstimate<3> found = fixed.estimate();
  CHECK((found.xi - truth).norm() < 1e-8);
  CHECK(found.noise < 1e-9);
  CHECK((dynamic.estimate().xi - found.xi).norm() < 1e-9);
}

TEST_CASE("a derivative needs no differentiation, and what z is at the ends is left open") {
  // y' = -1.5 y + 2 u + 0.7 for u = sum of sines, solved in closed form, from y(0) = 3.
  RecursiveBand<3, 39> band(frequencies(), {.differentiate = true});
  const double a = 1.5;
  double transient = 3.0 - 0.7 / a;
  const double pace[] = {2.3, 5.1, 9.7};
  for (const double w : pace) transient -= 2.0 * -w / (a * a + w * w);
  for (int k = 0; k < 2000; ++k) {
    const double t = dt * k;
    double u = 0.0;
    double y = 0.7 / a + transient * std::exp(-a * t);
    for (const double w : pace) {
      u += std::sin(w * t);
      y += 2.0 * (a * std::sin(w * t) - w * std::cos(w * t)) / (a * a + w * w);
    }
    CHECK(band.absorb(t, Eigen::Vector3d(y, u, 1.0), y));
  }
  const auto found = band.estimate();
  // Differences in time would be off by some per cent.
  CHECK(found.xi[0] == doctest::Approx(-1.5).epsilon(1e-3));
  CHECK(found.xi[1] == doctest::Approx(2.0).epsilon(1e-3));
  CHECK(found.xi[2] == doctest::Approx(0.7).epsilon(1e-2));
}

TEST_CASE("intervals hold as often as they say, from ten to thirty seconds, forgetting or not") {
  // Records of white noise: 95 % of intervals, and four deviations of chance.
  constexpr int records = 100;
  constexpr int rows = 1500;
  for (const double forgetting : {1.0, 0.997}) {
    int held[3] = {0, 0, 0};
    double noise = 0.0;
    for (std::uint64_t seed = 0; seed < records; ++seed) {
      Draws draws(5000 + seed);
      RecursiveBand<2, 39> band(frequencies(), {.forgetting = forgetting});
      const int looks[] = {500, 1000, rows};
      int at = 0;
      for (int k = 0; k < rows; ++k) {
        const double t = dt * k;
        const Eigen::Vector2d row(waves(t, 0.1 * static_cast<double>(seed)), waves(1.3 * t, 2.0));
        band.absorb(t, row, 1.5 * row[0] - 0.5 * row[1] + draws.normal_matrix(1, 1)(0, 0));
        if (k + 1 != looks[at]) continue;
        const auto found = band.estimate();
        held[at++] += std::abs(found.xi[0] - 1.5) < 1.96 * found.deviation[0] ? 1 : 0;
        if (at == 3) noise += found.noise / records;
      }
    }
    for (const int count : held) {
      CHECK(std::abs(count - 0.95 * records) < 4.0 * std::sqrt(0.05 * 0.95 * records));
    }
    CHECK(noise == doctest::Approx(1.0).epsilon(0.05));
  }
}

TEST_CASE("what changes is followed by a band that forgets") {
  RecursiveBand<1, 39> keeps(frequencies());
  RecursiveBand<1, 39> forgets(frequencies(), {.forgetting = 0.99});
  for (int k = 0; k < 3000; ++k) {
    const double t = dt * k;
    const Eigen::Matrix<double, 1, 1> row(waves(t, 0.5));
    const double z = (k < 1500 ? 2.0 : 1.0) * row[0];
    keeps.absorb(t, row, z);
    forgets.absorb(t, row, z);
  }
  CHECK(std::abs(keeps.estimate().xi[0] - 1.5) < 0.1);
  CHECK(std::abs(forgets.estimate().xi[0] - 1.0) < 0.01);
}

TEST_CASE("what is no row changes nothing, and too few say nothing") {
  RecursiveBand<2, 39> band(frequencies());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(std::isnan(band.estimate().noise));
  CHECK(band.absorb(0.0, {1.0, 2.0}, 3.0));
  CHECK_FALSE(band.absorb(0.0, {1.0, 2.0}, 3.0));
  CHECK_FALSE(band.absorb(-1.0, {1.0, 2.0}, 3.0));
  CHECK_FALSE(band.absorb(1.0, {nan, 2.0}, 3.0));
  CHECK_FALSE(band.absorb(nan, {1.0, 2.0}, 3.0));
  CHECK_FALSE(band.absorb(1.0, {1.0, 2.0}, nan));
  for (int k = 1; k < 20; ++k) CHECK(band.absorb(dt * k, {waves(dt * k, 0.0), 2.0}, 3.0));
  CHECK(std::isnan(band.estimate().deviation[0]));
}

}  // namespace recursive_band_test
