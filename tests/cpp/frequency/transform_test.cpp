// SPDX-License-Identifier: BSD-3-Clause
// The finite Fourier transform against closed forms, and a band's frequencies.
#include "sepcal/detail/frequency/transform.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "draws.hpp"
#include "sepcal/error.hpp"

namespace transform_test {

using doctest::Approx;
using doctest::Contains;
using sepcal::Band;
using sepcal::Error;

namespace {

constexpr double pi = std::numbers::pi;

std::vector<double> every(double step, std::size_t rows) {
  std::vector<double> time;
  for (std::size_t k = 0; k < rows; ++k) time.push_back(100.0 + step * static_cast<double>(k));
  return time;
}

}  // namespace

TEST_CASE("a sine of whole periods stands at its frequency alone") {
  const std::vector<double> time = every(0.02, 1000);  // 20 s
  Eigen::MatrixXd columns(1000, 1);
  const double middle = 0.5 * (time.front() + time.back());
  for (Eigen::Index k = 0; k < 1000; ++k) {
    columns(k, 0) = 3.0 * std::cos(2 * pi * 0.5 * (time[static_cast<std::size_t>(k)] - middle));
  }
  const std::vector<double> frequencies = sepcal::frequencies_of({0.4, 0.6, 0.05}, 20.0);
  REQUIRE(frequencies.size() == 5);
  const Eigen::MatrixXcd X = sepcal::fourier_transform(columns, time, frequencies);
  CHECK(X(2, 0).real() == Approx(3.0 * std::sqrt(2.0 / 1000) * 500));
  for (const Eigen::Index other : {0, 1, 3, 4}) CHECK(std::abs(X(other, 0)) < 1e-10);
}

TEST_CASE("white noise has parts of its own variance") {
  sepcal::test::Draws draws(5);
  const std::vector<double> time = every(0.02, 2000);
  const Eigen::MatrixXd columns =
      Eigen::MatrixXd::NullaryExpr(2000, 20, [&] { return 0.3 * draws.normal(); });
  const auto frequencies = sepcal::frequencies_of({0.1, 5.0, 0.0}, sepcal::duration_of(time));
  CHECK(frequencies.size() == 197);  // 1/40 Hz apart
  CHECK(frequencies.front() == Approx(0.1));
  const Eigen::MatrixXcd X =
      sepcal::fourier_transform(sepcal::without_line(columns, time), time, frequencies);
  const auto count = static_cast<double>(X.size());
  CHECK(X.real().squaredNorm() / count == Approx(0.09).epsilon(0.05));
  CHECK(X.imag().squaredNorm() / count == Approx(0.09).epsilon(0.05));
}

TEST_CASE("a straight line is nothing, whatever the times") {
  std::vector<double> time = every(0.02, 50);
  time[20] += 0.007;
  Eigen::MatrixXd columns(50, 2);
  for (Eigen::Index k = 0; k < 50; ++k) {
    columns.row(k) << 4.0 - 2.0 * time[static_cast<std::size_t>(k)], 7.0;
  }
  CHECK(sepcal::without_line(columns, time).cwiseAbs().maxCoeff() < 1e-10);
}

TEST_CASE("a drift is its steps, each frequency by itself, once its ends are taken off") {
  sepcal::test::Draws draws(7);
  const std::vector<double> time = every(0.02, 1000);
  Eigen::MatrixXd walk(1000, 1);
  Eigen::MatrixXd steps(1000, 1);
  double at = 5.0;
  for (Eigen::Index k = 0; k < 1000; ++k) {
    walk(k, 0) = at;
    steps(k, 0) = draws.normal();
    at += steps(k, 0);
  }
  const auto frequencies = sepcal::frequencies_of({0.1, 2.0, 0.0}, 20.0);
  REQUIRE(frequencies.front() == Approx(0.1));
  REQUIRE(frequencies.size() == 39);
  // x_(k+1) - x_k summed over the whole: (z - 1) X = steps - z w_0 (x_0 - x_N).
  const Eigen::MatrixXcd W = sepcal::fourier_transform(steps, time, frequencies);
  Eigen::MatrixXcd cyclic(W.rows(), 1);
  for (Eigen::Index m = 0; m < W.rows(); ++m) {
    const auto f = frequencies[static_cast<std::size_t>(m)];
    cyclic(m, 0) = W(m, 0) / (std::polar(1.0, 2.0 * pi * f * 0.02) - 1.0);
  }
  const Eigen::MatrixXcd X = sepcal::fourier_transform(walk, time, frequencies);
  const Eigen::MatrixXcd left = sepcal::without_ends(X, time, frequencies);
  const Eigen::MatrixXcd expected = sepcal::without_ends(cyclic, time, frequencies);
  CHECK((left - expected).norm() < 1e-2 * expected.norm());
}

TEST_CASE("bands that are none are refused") {
  const auto refuse = [](Band band, const char* message) {
    CHECK_THROWS_WITH_AS(sepcal::frequencies_of(band, 10.0), Contains(message), Error);
  };
  refuse({0.0, 2.0, 0.0}, "is none");
  refuse({2.0, 1.0, 0.0}, "is none");
  refuse({0.1, std::nan(""), 0.0}, "is none");
  refuse({0.1, 2.0, -0.1}, "can't be -0.1 Hz apart");
  refuse({0.1, 0.15, 0.0}, "less than two frequencies 0.1 Hz apart");
  refuse({0.1, 2.0, 1e-9}, "more than 100000");
}

}  // namespace transform_test
