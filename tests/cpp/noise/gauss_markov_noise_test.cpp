// SPDX-License-Identifier: BSD-3-Clause
// White noise beside a drift, and the noise behind a residual, by restricted likelihood, against
// dense covariances and in noise of known kind.
#include "noise/gauss_markov_noise.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "estimation/residual_colour.hpp"
#include "noises.hpp"
#include "numerics/decompositions.hpp"

namespace gauss_markov_noise_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace sepcal;
using namespace sepcal::test;
using estimation::find_restricted_noise;
using estimation::is_white;
using estimation::OutputNoise;
using noise::GaussMarkovNoise;

namespace {

const std::vector<Segment> runs{{"", 0, 150}, {"", 150, 240}};
constexpr Index rows = 240;

/// Of unit variance, run by run.
MatrixXd dense(const GaussMarkovNoise& noise) {
  MatrixXd Sigma = noise.white * MatrixXd::Identity(rows, rows);
  for (const Segment& run : runs) {
    for (auto i = static_cast<Index>(run.first); i < static_cast<Index>(run.last); ++i) {
      for (auto j = static_cast<Index>(run.first); j < static_cast<Index>(run.last); ++j) {
        Sigma(i, j) +=
            (1.0 - noise.white) * std::exp(-static_cast<double>(std::abs(i - j)) / noise.rows);
      }
    }
  }
  return Sigma;
}

double log_determinant(const MatrixXd& matrix) {
  return 2.0 * matrix.llt().matrixLLT().diagonal().array().log().sum();
}

/// A level and slow waves, orthonormal.
MatrixXd slow_columns(Index length, Index count) {
  MatrixXd X(length, count);
  for (Index k = 0; k < count; ++k) {
    X.col(k) = (VectorXd::LinSpaced(length, 0.0, 3.0 * static_cast<double>(k))).array().cos();
  }
  const Eigen::HouseholderQR<MatrixXd> qr(X);
  return qr.householderQ() * MatrixXd::Identity(length, count);
}

/// -2 ln L of the contrasts K'e, K orthonormal and orthogonal to X: the definition.
double contrast_likelihood(const MatrixXd& X, const VectorXd& e, const MatrixXd& Sigma) {
  const Eigen::HouseholderQR<MatrixXd> qr(X);
  const MatrixXd Q = qr.householderQ() * MatrixXd::Identity(rows, rows);
  const MatrixXd K = Q.rightCols(rows - X.cols());
  const MatrixXd S = K.transpose() * Sigma * K;
  const VectorXd y = K.transpose() * e;
  const auto n = static_cast<double>(y.size());
  return n * std::log(y.dot(S.ldlt().solve(y)) / n) + log_determinant(S);
}

/// A residual of slow columns in a noise.
VectorXd residual_of(const MatrixXd& X, VectorXd e) { return e - X * (X.transpose() * e); }

}  // namespace

TEST_CASE(
    "the restricted likelihood is that of the contrasts, X' Sigma X that of the dense Sigma") {
  Draws draws(21);
  const MatrixXd X = slow_columns(rows, 4);
  MatrixXd columns(rows, 5);
  columns << X, draw_noise("AR(0.9)", rows, draws);
  const noise::GaussMarkovFit fit = noise::fit_gauss_markov(columns, runs);
  GaussMarkovNoise unit = fit.noise;
  unit.sigma = 1.0;
  const MatrixXd Sigma = dense(unit);
  CHECK(fit.restricted.minus_two_log_likelihood ==
        Approx(contrast_likelihood(X, columns.col(4), Sigma)).epsilon(1e-8));
  CHECK((covariance_product(unit, runs, X) - X.transpose() * Sigma * X).norm() < 1e-10);
  const noise::GaussMarkovFit white = noise::fit_white_rows(columns);
  CHECK(white.restricted.minus_two_log_likelihood ==
        Approx(contrast_likelihood(X, columns.col(4), MatrixXd::Identity(rows, rows))));
}

TEST_CASE("a noise of free level and one without are held against each other by the same rows") {
  // A random walk by its differences, and the nearly same wandering noise of very long memory.
  Draws draws(22);
  const MatrixXd X = slow_columns(rows, 3).rightCols(2);
  MatrixXd levels = MatrixXd::Zero(rows, 2);
  levels.col(0).head(150).setConstant(1.0 / std::sqrt(150.0));
  levels.col(1).tail(90).setConstant(1.0 / std::sqrt(90.0));
  const MatrixXd within = X - levels * (levels.transpose() * X);
  const Eigen::HouseholderQR<MatrixXd> qr(within);
  const MatrixXd basis = qr.householderQ() * MatrixXd::Identity(rows, 2);
  MatrixXd columns(rows, 5);
  columns << levels, basis, draw_noise("random walk", rows, draws);
  NoiseModel walk{.d = 1.0 - 1e-12, .free_level = true};
  const double free =
      noise::restricted_likelihood(columns.rightCols(3), runs, walk).minus_two_log_likelihood;
  const GaussMarkovNoise slow{.rows = 1e7, .white = 0.0, .sigma = 1.0};
  MatrixXd bounded(rows, 4);
  bounded << levels, basis;
  const double with_levels = contrast_likelihood(bounded, columns.col(4), dense(slow));
  CHECK(free == Approx(with_levels).epsilon(1e-4));
}

TEST_CASE("the noise found behind a residual has the variance that its columns are moved by") {
  // Of slow columns in AR(0.9), whose covariance is known: by plain likelihood it comes out too
  // small, the columns having taken what is slow.
  constexpr Index length = 300;
  const std::vector<Segment> whole{{"", 0, length}};
  const MatrixXd X = slow_columns(length, 10);
  MatrixXd Sigma(length, length);
  for (Index i = 0; i < length; ++i) {
    for (Index j = 0; j < length; ++j) {
      Sigma(i, j) = std::pow(0.9, static_cast<double>(std::abs(i - j)));
    }
  }
  const VectorXd expected = (X.transpose() * Sigma * X).diagonal();
  std::vector<double> ratios;
  std::vector<double> plain_ratios;
  for (int seed = 0; seed < 61; ++seed) {
    Draws draws(static_cast<std::uint64_t>(seed));
    const VectorXd e = residual_of(X, draw_autoregression(0.9, length, draws));
    const auto found = find_restricted_noise(e, X, whole);
    const auto plain = estimation::find_residual_noise(as_span(e), whole);
    REQUIRE(found);
    REQUIRE(plain);
    const MatrixXd restricted = estimation::covariance_product(*found, 1.0, whole, X);
    const MatrixXd unrestricted = covariance_product(*plain, whole, X);
    ratios.push_back((restricted.diagonal().array() / expected.array()).mean());
    plain_ratios.push_back((unrestricted.diagonal().array() / expected.array()).mean());
  }
  std::ranges::nth_element(ratios, ratios.begin() + 30);
  std::ranges::nth_element(plain_ratios, plain_ratios.begin() + 30);
  CHECK(ratios[30] > 0.75);
  CHECK(ratios[30] < 1.35);
  CHECK(plain_ratios[30] < 0.7);
}

TEST_CASE("noise that moves with a column is not taken for slow noise") {
  // z = 2 x of an input that is logged with slow waves of noise: the column moves with it.
  constexpr Index length = 3000;
  const std::vector<Segment> whole{{"", 0, length}};
  int told = 0;
  std::vector<double> ratios;
  for (int seed = 0; seed < 40; ++seed) {
    Draws draws(static_cast<std::uint64_t>(seed));
    const VectorXd wandering = draw_autoregression(0.9, length, draws);
    VectorXd off = VectorXd::Zero(length);  // no slow waves, as smoothed fixes have
    off.head(length - 30) = wandering.tail(length - 30) - wandering.head(length - 30);
    MatrixXd X(length, 2);
    X.col(0).setOnes();
    X.col(1) = 30.0 * VectorXd::LinSpaced(length, 0.0, 9.0).array().sin().matrix() + off;
    const VectorXd z = 2.0 * (X.col(1) - off) + 0.1 * VectorXd(draws.normal_matrix(length, 1));
    const VectorXd e = z - X * X.householderQr().solve(z);
    const auto found = find_restricted_noise(e, X, whole);
    REQUIRE(found);
    told += found->moves_with_columns ? 1 : 0;
    ratios.push_back(estimation::covariance_product(*found, 1.0, whole, X.col(0)).value() /
                     static_cast<double>(length));
  }
  CHECK(told >= 36);
  std::ranges::nth_element(ratios, ratios.begin() + 20);
  CHECK(ratios[20] < 60.0);  // slow noise that lasts as long as the waves would be in the thousands
  // Noise that knows nothing of the columns is never taken for such, be they slow or fast.
  for (const std::string& kind : noise_kinds) {
    CAPTURE(kind);
    int taken = 0;
    for (int seed = 0; seed < 40; ++seed) {
      Draws draws(static_cast<std::uint64_t>(seed));
      MatrixXd X = slow_columns(rows, 4);
      if (seed % 2 == 0) X.col(3) = draws.normal_matrix(rows, 1);
      const VectorXd z = draw_noise(kind, rows, draws);
      const auto found = find_restricted_noise(z - X * X.householderQr().solve(z), X, runs);
      REQUIRE(found);
      taken += found->moves_with_columns ? 1 : 0;
    }
    CHECK(taken <= 1);
  }
}

TEST_CASE("rows that were held or interpolated are told, and slow noise is not taken for them") {
  constexpr Index length = 600;
  const std::vector<Segment> whole{{"", 0, length}};
  Draws draws(23);
  const VectorXd answers = draw_noise("white", length / 5 + 2, draws);
  VectorXd held(length);
  VectorXd straight(length);
  for (Index t = 0; t < length; ++t) {
    const double share = static_cast<double>(t % 5) / 5.0;
    held[t] = answers[t / 5];
    straight[t] = (1.0 - share) * answers[t / 5] + share * answers[t / 5 + 1];
  }
  CHECK(estimation::find_held_rows(held, whole) == 5);
  const Index interpolated = estimation::find_held_rows(straight, whole);
  CHECK(interpolated >= 3);
  CHECK(interpolated <= 6);
  for (const std::string& kind : noise_kinds) {
    CAPTURE(kind);
    CHECK(estimation::find_held_rows(draw_noise(kind, length, draws), whole) == 1);
  }
}

TEST_CASE("rows are summed as far as the columns are slow") {
  const std::vector<Segment> whole{{"", 0, 4000}};
  MatrixXd X(4000, 2);
  X.col(0).setOnes();
  X.col(1) = VectorXd::LinSpaced(4000, 0.0, 40.0).array().sin();
  const Index slow = estimation::find_slow_rows(X, whole);
  CHECK(slow == 8);
  X.col(1) = VectorXd::LinSpaced(4000, 0.0, 4000.0).array().sin();
  CHECK(estimation::find_slow_rows(X, whole) == 1);
  const estimation::SummedRows sums(X.col(0), whole, 8);
  CHECK(sums.columns.rows() == 500);
  CHECK(sums.columns.squaredNorm() == Approx(4000.0));
}

TEST_CASE("white noise is nearly always called white") {
  int coloured = 0;
  for (int seed = 0; seed < 100; ++seed) {
    Draws draws(static_cast<std::uint64_t>(seed));
    const MatrixXd X = slow_columns(rows, 5);
    const VectorXd e = residual_of(X, draw_noise("white", rows, draws));
    const auto found = find_restricted_noise(e, X, runs);
    REQUIRE(found);
    coloured += is_white(*found) ? 0 : 1;
  }
  CHECK(coloured <= 5);
}

}  // namespace gauss_markov_noise_test
