// SPDX-License-Identifier: BSD-3-Clause
// Noise that comes into several outputs by one input.
#include "diagnosis/input_noise.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "diagnosis/common_cause.hpp"
#include "draws.hpp"

namespace input_noise_test {

using Eigen::Index;
using Eigen::MatrixXd;
using namespace sepcal::diagnosis;
using sepcal::test::Draws;

constexpr Index rows = 1200;

/// Two outputs with noise of their own, and an input's of that size along a heading that turns: it
/// stays at 45 deg for a third of the record. The slopes are the input's, in a unit of its own.
struct Turning {
  MatrixXd white = MatrixXd(rows, 2);
  MatrixXd slopes = MatrixXd(2 * rows, 1);

  Turning(double size, Draws& draws) {
    for (Index row = 0; row < rows; ++row) {
      const double heading = row < rows / 3 ? 0.785 : 0.01 * static_cast<double>(row);
      const double slope[] = {std::cos(heading), std::sin(heading)};
      const double noise = size * draws.normal();
      for (Index j = 0; j < 2; ++j) {
        white(row, j) = draws.normal() + slope[j] * noise;
        slopes(j * rows + row, 0) = 1000.0 * slope[j];
      }
    }
  }
};

TEST_CASE("an input's noise is no common cause, however loud") {
  for (const double size : {0.0, 0.5, 1.0, 3.0}) {
    CAPTURE(size);
    int raw = 0;
    int independent = 0;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      Draws draws(seed);
      const Turning flown(size, draws);
      raw += find_common_cause(flown.white, seed).p_value <= 0.05;
      const MatrixXd taken = InputNoise(flown.white, flown.slopes).take_out(flown.white);
      independent += find_common_cause(taken, seed).p_value <= 0.05;
    }
    CHECK(independent <= 12);  // of 100, at 5 %: with probability 0.998
    if (size >= 1.0) CHECK(raw >= 95);
  }
}

TEST_CASE("outputs are of one size after it, and what no input does stays") {
  Draws draws(7);
  Turning flown(2.0, draws);
  const MatrixXd taken = InputNoise(flown.white, flown.slopes).take_out(flown.white);
  const MatrixXd covariance = taken.transpose() * taken / static_cast<double>(rows);
  CHECK(covariance(0, 0) == doctest::Approx(1.0).epsilon(0.1));
  CHECK(covariance(1, 1) == doctest::Approx(1.0).epsilon(0.1));
  CHECK(std::abs(covariance(0, 1)) < 0.1);
  for (Index row = 600; row < 800; ++row) {
    const double swing = 2.0 * std::sin(0.7 * static_cast<double>(row));
    flown.white(row, 0) += swing;
    flown.white(row, 1) -= swing;
  }
  const MatrixXd after = InputNoise(flown.white, flown.slopes).take_out(flown.white);
  CHECK(find_common_cause(after, 1).p_value < 0.005);
}

/// Of estimates of a column's size by least squares, each in the noise that the tests suppose.
TEST_CASE("columns are thrown about by as much as it says") {
  Draws of_columns(5);
  for (const double size : {0.0, 1.0, 3.0}) {
    CAPTURE(size);
    for (const bool is_along : {true, false}) {
      CAPTURE(is_along);
      Draws first(1000);
      const Turning example(size, first);
      MatrixXd column(2 * rows, 1);
      for (Index row = 0; row < rows; ++row) {
        const double driver = of_columns.normal();
        const double a = example.slopes(row, 0) / 1000.0;
        const double b = example.slopes(rows + row, 0) / 1000.0;
        column(row, 0) = driver * (is_along ? a : -b);
        column(rows + row, 0) = driver * (is_along ? b : a);
      }
      column /= column.norm();
      double thrown = 0.0;
      double told = 0.0;
      constexpr int flights = 400;
      for (std::uint64_t seed = 0; seed < flights; ++seed) {
        Draws draws(2000 + seed);
        const Turning flown(size, draws);
        const double estimate = column.col(0).dot(flown.white.reshaped());
        const double supposed = flown.white.squaredNorm() / static_cast<double>(2 * rows);
        thrown += estimate * estimate / supposed / flights;
        if (seed < 20) told += InputNoise(flown.white, flown.slopes).inflation(column) / 20.0;
      }
      // A mean of 400 squares is off by 7 % of itself; along the noise they are the larger.
      if (is_along) CHECK(told == doctest::Approx(std::max(1.0, thrown)).epsilon(0.25));
      if (!is_along) CHECK(told == doctest::Approx(1.0).epsilon(0.05));
    }
  }
}

TEST_CASE("without inputs nothing changes") {
  Draws draws(3);
  const Turning flown(0.0, draws);
  const InputNoise none(flown.white, MatrixXd(2 * rows, 0));
  CHECK(none.take_out(flown.white) == flown.white);
  CHECK(none.inflation(MatrixXd::Random(2 * rows, 1)) == 1.0);
}

}  // namespace input_noise_test
