// SPDX-License-Identifier: BSD-3-Clause
// Draws of xi2 within its bounds.
#include "estimation/sampling.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "numerics/quantiles.hpp"
#include "sepcal/error.hpp"

namespace sampling_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using sepcal::FitOptions;
using sepcal::Variable;
using sepcal::estimation::draw_samples;

namespace {

const std::vector<Variable> plane{{"x", "1", -2, 6}, {"y", "1", 10, 11}};

/// Cells of a 16 x 16 grid over the plane's bounds that hold no sample.
int empty_cells(const MatrixXd& samples) {
  std::set<std::pair<int, int>> filled;
  for (const auto& point : samples.colwise()) {
    filled.insert(
        {static_cast<int>(16 * (point[0] + 2) / 8), static_cast<int>(16 * (point[1] - 10))});
  }
  return 256 - static_cast<int>(filled.size());
}

FitOptions options_for(int samples, std::uint64_t seed = 0) {
  FitOptions options;
  options.samples = samples;
  options.seed = seed;
  return options;
}

}  // namespace

TEST_CASE("uniform samples lie within the bounds with a uniform's mean and variance") {
  const MatrixXd samples = draw_samples(plane, options_for(4000));
  CHECK(samples.rows() == 2);
  CHECK(samples.cols() == 4000);
  CHECK((samples.row(0).array() > -2).all());
  CHECK((samples.row(0).array() < 6).all());
  const double mean = samples.row(0).mean();
  const double sd = 8 / std::sqrt(12.0);
  CHECK(std::abs(mean - 2) < 5 * sd / std::sqrt(4000.0));
  const double variance = (samples.row(0).array() - mean).square().mean();
  CHECK(variance == Approx(sd * sd).epsilon(5 * std::sqrt(0.8 / 4000)));  // kurtosis 1.8
}

TEST_CASE("the same seed gives the same samples, another seed others") {
  for (const auto sampling : {sepcal::Sampling::uniform, sepcal::Sampling::low_discrepancy}) {
    FitOptions options = options_for(50, 7);
    options.sampling = sampling;
    const MatrixXd once = draw_samples(plane, options);
    CHECK(once == draw_samples(plane, options));
    options.seed = 8;
    CHECK(once != draw_samples(plane, options));
  }
}

TEST_CASE("a low-discrepancy sequence leaves fewer cells empty than uniform draws") {
  for (const std::uint64_t seed : {0U, 1U, 2U, 3U}) {
    FitOptions options = options_for(512, seed);
    const int uniform = empty_cells(draw_samples(plane, options));
    options.sampling = sepcal::Sampling::low_discrepancy;
    const MatrixXd even = draw_samples(plane, options);
    CHECK((even.row(1).array() >= 10).all());
    CHECK((even.row(1).array() <= 11).all());
    CHECK(2 * empty_cells(even) < uniform);  // 256 exp(-2) = 35 are left by chance
  }
}

TEST_CASE("a normal sampling distribution has its mean and variance, and its bounds truncate it") {
  FitOptions options = options_for(4000);
  options.sampling_distribution = {{"x", {1.0, 0.2}}, {"y", {10.0, 0.1}}};
  const MatrixXd samples = draw_samples(plane, options);
  const double mean = samples.row(0).mean();
  CHECK(std::abs(mean - 1.0) < 5 * 0.2 / std::sqrt(4000.0));
  CHECK((samples.row(0).array() - mean).square().mean() ==
        Approx(0.04).epsilon(5 * std::sqrt(2.0 / 4000)));
  // y: the upper half of a normal about its lower bound has the mean sd sqrt(2 / pi).
  CHECK(samples.row(1).minCoeff() >= 10.0);
  const double half_mean = samples.row(1).mean() - 10.0;
  CHECK(std::abs(half_mean - 0.0797885) < 5 * 0.1 * 0.603 / std::sqrt(4000.0));
}

TEST_CASE("both tails of a normal are drawn alike, however far out the bounds are") {
  FitOptions options = options_for(200);
  options.sampling_distribution = {{"x", {0, 1}}};
  MatrixXd below = draw_samples({{"x", "1", -9, -8}}, options);
  MatrixXd above = draw_samples({{"x", "1", 8, 9}}, options);
  CHECK(below.minCoeff() >= -9);
  CHECK(above.maxCoeff() <= 9);
  std::ranges::sort(below.reshaped());
  std::ranges::sort(above.reshaped());
  CHECK(std::set<double>(below.reshaped().begin(), below.reshaped().end()).size() == 200);
  CHECK(std::set<double>(above.reshaped().begin(), above.reshaped().end()).size() == 200);
}

TEST_CASE("the normal quantile agrees with published values and inverts erfc") {
  CHECK(sepcal::numerics::normal_quantile(0.5) == Approx(0.0).epsilon(1e-15));
  // SciPy 1.x, scipy.special.ndtri.
  CHECK(sepcal::numerics::normal_quantile(0.975) == Approx(1.959963984540054).epsilon(1e-14));
  CHECK(sepcal::numerics::normal_quantile(0.9) == Approx(1.2815515655446004).epsilon(1e-14));
  CHECK(sepcal::numerics::normal_quantile(0.01) == Approx(-2.3263478740408408).epsilon(1e-14));
  CHECK(sepcal::numerics::normal_quantile(1e-10) == Approx(-6.361340902404056).epsilon(1e-14));
  CHECK(sepcal::numerics::normal_quantile(1e-300) == Approx(-37.0470962993612).epsilon(1e-14));
}

TEST_CASE("the quantile is odd about the median, into the far tail") {
  for (const int power : {2, 10, 20, 30, 40}) {
    const double p = std::ldexp(1.0, -power);  // 1 - p is exact
    CAPTURE(power);
    CHECK(sepcal::numerics::normal_quantile(1.0 - p) ==
          Approx(-sepcal::numerics::normal_quantile(p)).epsilon(1e-14));
  }
}

TEST_CASE(
    "the nominal point is the middle of the bounds, the mean of what is drawn from, or near zero") {
  const double inf = sepcal::infinity;
  const std::vector<Variable> parameters{
      {"a", "1", -2, 6}, {"b", "1"}, {"c", "1", 3, inf}, {"d", "1", 0, 1}, {"e", "1", 0, 1}};
  FitOptions options;
  options.sampling_distribution = {{"d", {0.2, 1}}, {"e", {5, 1}}};
  Eigen::VectorXd expected(5);
  expected << 2, 0, 3, 0.2, 1;
  CHECK(sepcal::estimation::nominal_point(parameters, options) == expected);
}

}  // namespace sampling_test
