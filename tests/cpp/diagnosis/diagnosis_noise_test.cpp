// SPDX-License-Identifier: BSD-3-Clause
// The likelihood ratio of added columns: in closed form where noise is white, by dense generalised
// least squares where it isn't, with the drift that a whitener alone would hide; and what draws of
// the noise make of it.
#include "diagnosis/noise_test.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "diagnosis/null_hypothesis.hpp"
#include "diagnosis/projection.hpp"
#include "diagnosis/residual_noise.hpp"
#include "linearisations.hpp"
#include "noises.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/tails.hpp"

namespace diagnosis_noise_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace sepcal;
using namespace sepcal::test;

namespace {

MatrixXd perpendicular(const diagnosis::LinearisedFit& fit, const MatrixXd& columns) {
  return diagnosis::orthonormal_basis(
      diagnosis::remove_span(diagnosis::orthonormal_basis(fit.tangent), columns));
}

/// N ln(s0^2 / s1^2) of one output, by dense least squares.
double white_ratio(const diagnosis::LinearisedFit& fit, const MatrixXd& added) {
  MatrixXd columns(added.rows(), fit.tangent.cols() + added.cols());
  columns << fit.tangent, added;
  const VectorXd left = fit.residual - columns * least_squares(columns, fit.residual);
  return static_cast<double>(fit.layout.rows) *
         std::log(fit.residual.squaredNorm() / left.squaredNorm());
}

/// A level and two slow waves: what a wind box would leave of a tangent.
MatrixXd waves(Index rows) {
  const VectorXd t = VectorXd::LinSpaced(rows, 0.0, 2.0 * std::numbers::pi);
  MatrixXd columns(rows, 3);
  columns << VectorXd::Ones(rows), (3.0 * t.array()).sin().matrix(),
      (5.0 * t.array()).cos().matrix();
  return columns;
}

/// 250 s of a velocity [m/s], noise 0.15, at 5 Hz, with a wind that changes by `drift` in all.
struct Drifting {
  static constexpr Index rows = 1250;
  diagnosis::RowLayout layout = make_layout({{"", rows}}, {1.0});
  VectorXd ramp = VectorXd::LinSpaced(rows, -0.5, 0.5);
  diagnosis::LinearisedFit fit;

  explicit Drifting(double drift, std::uint64_t seed = 5) {
    Draws draws(seed);
    fit = fit_to(layout, waves(rows), drift * ramp + 0.15 * draws.normal_matrix(rows, 1));
    const double rmse = fit.residual.norm() / std::sqrt(double{rows});
    fit.residual /= rmse;
    fit.layout.outputs[0].scale = rmse;
  }
};

}  // namespace

TEST_CASE("white noise: N ln of the variances' ratio, to the digit where no colour is found") {
  int without_colour = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Draws draws(seed);
    const diagnosis::RowLayout layout = make_layout({{"", 500}}, {1.0});
    const MatrixXd G = draws.normal_matrix(500, 2);
    const diagnosis::LinearisedFit fit =
        fit_to(layout, draws.normal_matrix(500, 3),
               G.col(0) * 0.4 + VectorXd(draws.normal_matrix(500, 1)));
    const diagnosis::NullHypothesis null = diagnosis::find_null(fit);
    const diagnosis::NoiseTest::Ratios ratios = null.test->compare(perpendicular(fit, G));
    const double expected = white_ratio(fit, G);
    CAPTURE(seed);
    CHECK(ratios.joint == Approx(expected).epsilon(0.1));
    const noise::NoiseMember& with = ratios.with.noise[0];
    const bool white = with.at == 0 && with.partial.size() == 0;  // of either family
    if (!white || std::abs(ratios.own[0] - ratios.own[1]) > 1e-9) continue;
    ++without_colour;
    CHECK(ratios.joint == Approx(expected).epsilon(1e-9));
  }
  CHECK(without_colour >= 3);
}

TEST_CASE("two outputs: the sum over them, whatever their scales") {
  Draws draws(31);
  const diagnosis::RowLayout layout = make_layout({{"a", 300}, {"b", 400}}, {0.1, 25.0});
  const MatrixXd G = draws.normal_matrix(1400, 1);
  VectorXd noise = draws.normal_matrix(1400, 1);
  noise.tail(700) *= 3.0;
  const diagnosis::LinearisedFit fit =
      fit_to(layout, draws.normal_matrix(1400, 4), 0.5 * G + noise);
  const diagnosis::NullHypothesis null = diagnosis::find_null(fit);
  const double ratio = null.test->compare(perpendicular(fit, G)).joint;

  // Weighted least squares by turns with the two variances.
  const auto minus_two_log_likelihood = [&](const MatrixXd& columns) {
    Eigen::Array2d sigma(1.0, 3.0);
    for (int turn = 0; turn < 30; ++turn) {
      VectorXd weight(1400);
      weight << VectorXd::Constant(700, 1 / sigma[0]), VectorXd::Constant(700, 1 / sigma[1]);
      const VectorXd x =
          least_squares(weight.asDiagonal() * columns, VectorXd(weight.cwiseProduct(fit.residual)));
      const VectorXd left = fit.residual - columns * x;
      sigma = Eigen::Array2d(left.head(700).norm(), left.tail(700).norm()) / std::sqrt(700.0);
    }
    return 1400.0 * sigma.log().sum();
  };
  MatrixXd both(1400, 5);
  both << fit.tangent, G;
  const double expected = minus_two_log_likelihood(fit.tangent) - minus_two_log_likelihood(both);
  CHECK(expected > 50.0);
  CHECK(ratio == Approx(expected).epsilon(0.05));
}

TEST_CASE("the estimate and its covariance are those of generalised least squares") {
  Draws draws(8);
  const diagnosis::RowLayout layout = make_layout({{"a", 400}, {"b", 500}}, {1.0});
  const MatrixXd G = draws.normal_matrix(900, 2);
  const diagnosis::LinearisedFit fit = fit_to(layout, draws.normal_matrix(900, 3),
                                              0.3 * G.col(1) + draw_noise("AR(0.9)", 900, draws));
  const diagnosis::NullHypothesis null = diagnosis::find_null(fit);
  const MatrixXd added = perpendicular(fit, G);
  const diagnosis::FamilyFit with = null.test->compare(added).with;
  MatrixXd columns(900, 5);
  columns << null.basis.columns().dense(layout), added;
  const MatrixXd identity = MatrixXd::Identity(900, 900);
  MatrixXd factor = identity;  // of the noise's covariance
  for (auto column : factor.colwise()) {
    noise::NoiseFamilies(layout.segments).colour(with.noise[0], column);
  }
  const MatrixXd inverse = (factor * factor.transpose()).ldlt().solve(identity);
  const MatrixXd covariance = (columns.transpose() * inverse * columns).inverse();
  const VectorXd expected = covariance * columns.transpose() * inverse * fit.residual;
  for (Index k = 0; k < 5; ++k) {
    const double error = std::sqrt(covariance(k, k));
    CHECK(std::abs(with.coefficients[k] - expected[k]) < 0.02 * error);
    CHECK(std::sqrt(with.covariance(k, k)) == Approx(error).epsilon(0.03));
  }
}

TEST_CASE("the larger hypothesis is never the worse one") {
  for (const std::string& kind : noise_kinds) {
    CAPTURE(kind);
    Draws draws(17);
    const diagnosis::RowLayout layout = make_layout({{"a", 150}, {"b", 250}}, {1.0, 1.0});
    VectorXd noise(800);
    noise << draw_noise(kind, 400, draws), draw_noise(kind, 400, draws);
    const diagnosis::LinearisedFit fit = fit_to(layout, draws.normal_matrix(800, 4), noise);
    const diagnosis::NullHypothesis null = diagnosis::find_null(fit);
    MatrixXd columns(800, 0);
    double last = infinity;
    for (int q = 1; q <= 4; ++q) {
      columns.conservativeResize(Eigen::NoChange, q);
      columns.col(q - 1) = draws.normal_matrix(800, 1);
      const diagnosis::NoiseTest::Ratios ratios = null.test->compare(perpendicular(fit, columns));
      CHECK(ratios.joint >= 0.0);
      CHECK(ratios.with.minus_two_log_likelihood < last + 0.5);  // the grid's coarseness
      last = ratios.with.minus_two_log_likelihood;
    }
  }
}

TEST_CASE("a slow drift that the null's noise model swallows stands out in the ratio") {
  const Drifting flight(2.0);
  const diagnosis::NullHypothesis null = diagnosis::find_null(flight.fit);
  CHECK(null.best.noise[0].d > 0.2);  // the drift, taken for slow noise
  const MatrixXd added = perpendicular(flight.fit, flight.ramp);

  MatrixXd white = added;
  null.whiten(white);
  white = diagnosis::remove_span(null.white_basis, white);
  const double score = std::pow(white.col(0).dot(null.white_residual), 2) / white.squaredNorm();
  const diagnosis::NoiseTest::Ratios ratios = null.test->compare(added);
  CHECK(ratios.joint > 90.0);
  CHECK(score < 0.3 * ratios.joint);

  // With the ramp taken out the rest is white: the search comes down to its closed form.
  const VectorXd left = diagnosis::remove_span(added, flight.fit.residual);
  const double N = static_cast<double>(Drifting::rows);
  const double white_noise = N * std::log(left.squaredNorm() / N);
  CHECK(std::abs(ratios.with.minus_two_log_likelihood - white_noise) < 10.0);
}

TEST_CASE("the larger a drift, the larger its ratio") {
  for (const std::uint64_t seed : {5U, 6U, 7U}) {
    double last = 0.0;
    for (const double drift : {0.1, 0.5, 1.0, 2.0, 4.0, 8.0}) {
      CAPTURE(seed);
      CAPTURE(drift);
      const Drifting flight(drift, seed);
      const diagnosis::NullHypothesis null = diagnosis::find_null(flight.fit);
      const double ratio = null.test->compare(perpendicular(flight.fit, flight.ramp)).joint;
      CHECK(ratio > 0.5 * last);
      last = std::max(last, ratio);
    }
    CHECK(last > 60.0);
  }
}

TEST_CASE("without a drift the ratio of a ramp is that of chance") {
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Drifting flight(0.0, seed);
    const diagnosis::NullHypothesis null = diagnosis::find_null(flight.fit);
    sum += null.test->compare(perpendicular(flight.fit, flight.ramp)).joint;
  }
  CHECK(sum / 20.0 > 0.2);
  CHECK(sum / 20.0 < 2.5);  // 1 but for what a noise model takes of it
}

TEST_CASE("in white noise draws leave a tail as it is, the same with any number of threads") {
  Draws draws(12);
  const diagnosis::RowLayout layout = make_layout({{"", 390}}, {1.0});
  const MatrixXd G = draws.normal_matrix(390, 3);
  const diagnosis::LinearisedFit fit =
      fit_to(layout, draws.normal_matrix(390, 4), 0.25 * G.col(0) + draws.normal_matrix(390, 1));
  const diagnosis::NullHypothesis null = diagnosis::find_null(fit);
  const MatrixXd added = perpendicular(fit, G);
  const diagnosis::NoiseTest::Ratios ratios = null.test->compare(added);
  const diagnosis::NoiseTails plain = diagnosis::NoiseTest::tails(ratios, 3);
  base::ThreadPool pool(2);
  const diagnosis::NoiseTails drawn =
      null.test->calibrate(ratios, added, {.draws = 200, .seed = 1}, pool);
  CHECK(drawn.either >= plain.either);
  CHECK(drawn.either < 0.7 * plain.either);
  CHECK(drawn.beside < 0.7 * plain.beside);

  base::ThreadPool alone(1);
  CHECK(null.test->calibrate(ratios, added, {.draws = 200, .seed = 1}, alone).log10_p() ==
        drawn.log10_p());
  CHECK(null.test->calibrate(ratios, added, {.draws = 200, .seed = 2}, pool).log10_p() !=
        drawn.log10_p());
}

TEST_CASE("noise that wanders makes ramps: called found seldom, where chi-squared calls many") {
  base::ThreadPool pool(2);
  int by_chi_squared = 0;
  int found = 0;
  constexpr int flights = 40;
  for (std::uint64_t seed = 1; seed <= flights; ++seed) {
    Draws draws(seed);
    VectorXd noise = draws.normal_matrix(390, 1);
    double drift = draws.normal_matrix(1, 1)(0, 0);  // Gauss & Markov's, 100 rows
    const double phi = std::exp(-1.0 / 100.0);
    for (Index t = 0; t < noise.size(); ++t) {
      noise[t] += drift;
      drift = phi * drift + std::sqrt(1.0 - phi * phi) * draws.normal_matrix(1, 1)(0, 0);
    }
    const diagnosis::RowLayout layout = make_layout({{"", 390}}, {1.0});
    diagnosis::LinearisedFit fit = fit_to(layout, waves(390), noise);
    const diagnosis::NullHypothesis null = diagnosis::find_null(fit);
    const MatrixXd ramp = perpendicular(fit, VectorXd::LinSpaced(390, -1.0, 1.0));
    const diagnosis::NoiseTest::Ratios ratios = null.test->compare(ramp);
    const double white = white_ratio(fit, VectorXd::LinSpaced(390, -1.0, 1.0));
    by_chi_squared += numerics::log10_chi_squared_tail(white, 1.0) < -2.0 ? 1 : 0;
    found +=
        null.test->calibrate(ratios, ramp, {.draws = 80, .smooth = true}, pool).log10_p() < -2.0
            ? 1
            : 0;
  }
  CHECK(by_chi_squared > 20);
  CHECK(found <= 4);  // binomial, 1 % of 40: more than 4 in 1e-5 of all sets of seeds
}

TEST_CASE("points of chi-squared") {
  // SciPy 1.11: chi2.isf(0.5, 2), chi2.isf(0.1, 5)
  CHECK(numerics::chi_squared_point(0.5, 2.0) == Approx(1.3862943611198906).epsilon(1e-9));
  CHECK(numerics::chi_squared_point(0.1, 5.0) == Approx(9.236356899781123).epsilon(1e-9));
}

TEST_CASE("the residual in words: correlation, Ljung and Box, the floor in the output's unit") {
  Draws draws(2);
  const diagnosis::RowLayout layout = make_layout({{"a", 900}, {"b", 600}}, {0.5, 4.0});
  VectorXd noise(3000);
  noise << draw_noise("AR(0.9)", 1500, draws), draw_noise("white", 1500, draws);
  const diagnosis::LinearisedFit fit = fit_to(layout, draws.normal_matrix(3000, 2), noise);
  const std::vector<ResidualNoise> described =
      diagnosis::describe_residual(diagnosis::find_null(fit));
  REQUIRE(described.size() == 2);
  for (std::size_t j = 0; j < 2; ++j) {
    const VectorXd e = fit.residual.segment(layout.first(j), 1500);
    const VectorXd centred = e.array() - e.mean();
    double Q = 0.0;
    double first = 0.0;
    for (Index lag = 1; lag <= 20; ++lag) {
      double sum = 0.0;
      for (Index i = lag; i < 1500; ++i) {
        if (i < 900 || i - lag >= 900) sum += centred[i] * centred[i - lag];
      }
      const double r = sum / centred.squaredNorm();
      if (lag == 1) first = r;
      Q += 1500.0 * 1502.0 * r * r / static_cast<double>(1500 - lag);
    }
    CHECK(described[j].output == (j == 0 ? "z0" : "z1"));
    CHECK(described[j].unit == "m/s");
    CHECK(described[j].rmse == layout.outputs[j].scale);
    CHECK(described[j].lag_one == Approx(first).epsilon(1e-10));
    CHECK(described[j].ljung_box_p ==
          Approx(std::pow(10.0, numerics::log10_chi_squared_tail(Q, 20.0))).epsilon(1e-8));
  }
  CHECK(described[0].lag_one == Approx(0.9).epsilon(0.05));
  CHECK(described[0].ljung_box_p < 1e-50);
  CHECK(described[1].ljung_box_p > 1e-4);
  CHECK(described[0].floor == Approx(0.5 * std::sqrt(0.19)).epsilon(0.05));
  CHECK(described[1].floor == Approx(4.0).epsilon(0.05));
  CHECK(described[0].noise.sigma == described[0].floor);
}

}  // namespace diagnosis_noise_test
