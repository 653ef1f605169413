// SPDX-License-Identifier: BSD-3-Clause
// Error rates of what is built on the noise model: whitened residuals look white as often as they
// should, and a likelihood ratio of an irrelevant column rejects as often as it should.
#include <doctest/doctest.h>

#include <cmath>

#include "noises.hpp"
#include "sepcal/noise_model.hpp"
#include "studies/seeds.hpp"

namespace noise_calibration_study {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::fit_noise;
using sepcal::NoiseFit;
using sepcal::NoiseFitOptions;
using sepcal::Whitener;
using sepcal::test::as_span;
using sepcal::test::draw_noise;
using sepcal::test::Draws;
using sepcal::test::make_segments;
using sepcal::test::outside_binomial;

namespace {

/// Upper 5 % points of chi-squared with 11 to 20 degrees of freedom (SciPy chi2.isf).
constexpr double chi_squared_95[] = {19.675, 21.026, 22.362, 23.685, 24.996,
                                     26.296, 27.587, 28.869, 30.144, 31.410};

/// Ljung & Box's portmanteau of 20 lags, each with its own variance, sum of w_t^2 w_{t-k}^2 / N, so
/// that bursts count neither for nor against.
double portmanteau(const VectorXd& w) {
  double Q = 0;
  for (Index k = 1; k <= 20; ++k) {
    const Eigen::ArrayXd products = w.tail(w.size() - k).array() * w.head(w.size() - k).array();
    Q += products.sum() * products.sum() / products.square().sum();
  }
  return Q;
}

/// Few seeds show by their number what a kind of noise can't.
void check_few_in_all(int rejected, int of) {
  if (!sepcal::test::whole_study) CHECK_FALSE(outside_binomial(rejected, of, 0.05));
}

}  // namespace

TEST_CASE("a portmanteau of the whitened residual rejects near its nominal 5 %") {
  constexpr int seeds = sepcal::test::seeds(200);
  constexpr Index rows = 1000;
  const auto segments = make_segments({600, 400});
  int in_all = 0;
  for (const std::string& kind : sepcal::test::noise_kinds) {
    int rejected = 0;
    for (int seed = 0; seed < seeds; ++seed) {
      Draws draws(static_cast<std::uint64_t>(10000 + seed));
      VectorXd e(rows);
      e << draw_noise(kind, 600, draws), draw_noise(kind, 400, draws);
      const NoiseFit fit = fit_noise(as_span(e), segments);
      MatrixXd w = e;
      Whitener(fit.model, segments).apply(w);
      // d and phi were fitted: 20 - (p + 1) degrees of freedom.
      rejected += portmanteau(w.col(0)) > chi_squared_95[20 - (fit.model.order() + 1) - 11];
    }
    MESSAGE("portmanteau in ", kind, ": ", rejected, " of ", seeds);
    CHECK_FALSE(outside_binomial(rejected, seeds, 0.05));
    in_all += rejected;
  }
  check_few_in_all(in_all, static_cast<int>(sepcal::test::noise_kinds.size()) * seeds);
}

TEST_CASE("an irrelevant column: the likelihood ratio rejects at its nominal 5 %") {
  // The column is as coloured as drivers are; one step of generalised least squares, then the noise
  // re-estimated with the same order on both sides.
  constexpr int seeds = sepcal::test::seeds(400);
  constexpr Index rows = 400;
  const auto segments = make_segments({rows});
  int in_all = 0;
  for (const std::string driver : {"white", "AR(0.9)"}) {
    for (const std::string kind : {"white", "AR(0.9)", "pink"}) {
      int rejected = 0;
      for (int seed = 0; seed < seeds; ++seed) {
        Draws draws(static_cast<std::uint64_t>(20000 + seed));
        const VectorXd e = draw_noise(kind, rows, draws);
        const VectorXd column = draw_noise(driver, rows, draws);
        const NoiseFit null = fit_noise(as_span(e), segments);
        MatrixXd white(rows, 2);
        white << e, column;
        Whitener(null.model, segments).apply(white);
        const double step = white.col(1).dot(white.col(0)) / white.col(1).squaredNorm();
        const VectorXd rest = e - step * column;
        NoiseFitOptions options;
        options.start = null.model;
        const NoiseFit with = fit_noise(as_span(rest), segments, options);
        const NoiseFit without = fit_noise(as_span(e), segments, options);
        rejected += without.minus_two_log_likelihood - with.minus_two_log_likelihood > 3.841;
      }
      MESSAGE(kind, " against a column of ", driver, ": ", rejected, " of ", seeds);
      CHECK_FALSE(outside_binomial(rejected, seeds, 0.05));
      in_all += rejected;
    }
  }
  check_few_in_all(in_all, 6 * seeds);
}

}  // namespace noise_calibration_study
