// SPDX-License-Identifier: BSD-3-Clause
// fit_noise: what it recovers, that nothing fits better, and what it does where there is no noise.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "noises.hpp"
#include "sepcal/error.hpp"
#include "sepcal/noise_model.hpp"

namespace noise_fit_test {

using doctest::Approx;
using doctest::Contains;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Error;
using sepcal::fit_noise;
using sepcal::NoiseFit;
using sepcal::NoiseFitOptions;
using sepcal::NoiseModel;
using sepcal::Segment;
using sepcal::Whitener;
using sepcal::test::as_span;
using sepcal::test::draw_noise;
using sepcal::test::Draws;
using sepcal::test::make_segments;

namespace {

NoiseFitOptions order(int p) {
  NoiseFitOptions options;
  options.order = p;
  return options;
}

double minus_two_log_likelihood(const Whitener& whitener, MatrixXd e) {
  whitener.apply(e);
  return whitener.log_determinant() + e.squaredNorm() +
         static_cast<double>(whitener.informative_rows()) * std::log(2 * std::acos(-1.0));
}

}  // namespace

TEST_CASE("d of white, pink and a random walk: within its sampling error, sqrt(6 / N) / pi") {
  constexpr int seeds = 40;
  constexpr Index rows = 1000;
  const double error = std::sqrt(6.0 / rows) / std::acos(-1.0);
  for (const auto& [kind, d] : {std::pair{"white", 0.0}, {"pink", 0.5}, {"random walk", 1.0}}) {
    CAPTURE(kind);
    double sum = 0;
    for (int seed = 0; seed < seeds; ++seed) {
      Draws draws(static_cast<std::uint64_t>(600 + seed));
      const VectorXd e = draw_noise(kind, rows, draws);
      const NoiseFit fit = fit_noise(as_span(e), make_segments({rows}), order(0));
      CHECK(fit.converged);
      CHECK(fit.model.order() == 0);
      CHECK(std::abs(fit.model.d - d) < 4.5 * error + (d == 0.5 ? 0.1 : 0.001));
      sum += fit.model.d / seeds;
    }
    // Half of the estimates at a bound: the mean is 0.4 errors inside. Doubling time constants
    // make a spectrum that is 1/f only within its range: d is 0.5 to 0.06.
    if (d == 0.5) CHECK(std::abs(sum - 0.5) < 0.06);
    if (d != 0.5) CHECK(std::abs(sum - d) < 0.4 * error + 4.5 * error / std::sqrt(seeds) + 0.001);
  }
}

TEST_CASE(
    "AR(0.9): the one-step prediction and its error are recovered, also from short segments") {
  for (const std::vector<std::size_t>& lengths :
       {std::vector<std::size_t>{2000}, std::vector<std::size_t>(100, 20)}) {
    CAPTURE(lengths.size());
    double sum_phi = 0;
    double sum_sigma = 0;
    constexpr int seeds = 30;
    for (int seed = 0; seed < seeds; ++seed) {
      Draws draws(static_cast<std::uint64_t>(650 + seed));
      VectorXd e(2000);
      Index first = 0;
      for (const std::size_t length : lengths) {
        const auto n = static_cast<Index>(length);
        e.segment(first, n) = draw_noise("AR(0.9)", n, draws);
        first += n;
      }
      const NoiseFit fit = fit_noise(as_span(e), make_segments(lengths), order(1));
      // The first coefficient of phi(B) (1 - B)^d is -(phi + d).
      sum_phi += (fit.model.phi[0] + fit.model.d) / seeds;
      sum_sigma += fit.model.sigma / seeds;
    }
    CHECK(std::abs(sum_phi - 0.9) < 0.02);  // error 0.022 a seed, 0.004 of the mean, and the bias
    const double sigma = std::sqrt(1 - 0.81);
    CHECK(std::abs(sum_sigma / sigma - 1.0) < 4.5 * std::sqrt(0.5 / 2000 / seeds) + 0.005);
  }
}

TEST_CASE("nothing fits better: twice the gain over the truth is chi-squared, from any segments") {
  const std::vector<std::size_t> lengths{200, 20, 1, 20, 60, 99};
  const auto segments = make_segments(lengths);
  NoiseModel pink_ar{0.5, VectorXd::Constant(1, 0.4), 2.0};
  NoiseModel ar{0.2, VectorXd::Constant(1, 0.4), 2.0};
  NoiseModel slow{0.75, VectorXd(), 0.5};
  for (const NoiseModel& truth : {ar, pink_ar, slow}) {
    CAPTURE(truth.d);
    const Whitener whitener(truth, segments);
    std::mt19937_64 generator(7);
    constexpr Index draws = 60;
    const MatrixXd noise = sepcal::simulate_noise(truth, segments, draws, generator);
    double sum = 0;
    for (Index k = 0; k < draws; ++k) {
      const VectorXd e = noise.col(k);
      NoiseFitOptions options;
      options.start = truth;
      const NoiseFit fit = fit_noise(as_span(e), segments, options);
      CHECK(fit.model.order() == truth.order());
      CHECK(fit.informative_rows == whitener.informative_rows());
      CHECK(minus_two_log_likelihood(Whitener(fit.model, segments), e) ==
            Approx(fit.minus_two_log_likelihood).epsilon(1e-7));
      const double gain = minus_two_log_likelihood(whitener, e) - fit.minus_two_log_likelihood;
      CHECK(gain > -1e-3);
      sum += gain;
      // From another start the same minimum.
      options.start = NoiseModel{truth.d + (truth.d < 0.5 ? 0.1 : 0.15),
                                 VectorXd::Constant(truth.order(), 0.1), 1.0};
      const NoiseFit other = fit_noise(as_span(e), segments, options);
      CHECK(std::abs(other.minus_two_log_likelihood - fit.minus_two_log_likelihood) < 0.01);
    }
    const double freedom = truth.order() + 2.0;
    CHECK(std::abs(sum / draws - freedom) < 4.5 * std::sqrt(2 * freedom / draws) + 0.3);
  }
}

TEST_CASE("AIC: white noise is most often of order 0, and AR(2) of order 2 or more") {
  int white = 0;
  int second = 0;
  for (int seed = 0; seed < 50; ++seed) {
    Draws draws(static_cast<std::uint64_t>(700 + seed));
    VectorXd e = draw_noise("white", 400, draws);
    white += fit_noise(as_span(e), make_segments({400})).model.order() == 0;
    for (Index t = 2; t < 400; ++t) e[t] += 0.9 * e[t - 1] - 0.7 * e[t - 2];
    second += fit_noise(as_span(e), make_segments({400})).model.order() >= 2;
  }
  CHECK(white >= 25);
  CHECK(second == 50);
}

TEST_CASE("a re-estimation from its own result takes few evaluations and stays there") {
  Draws draws(750);
  for (const std::string& kind : sepcal::test::noise_kinds) {
    CAPTURE(kind);
    const VectorXd e = draw_noise(kind, 1000, draws);
    const auto segments = make_segments({600, 400});
    const NoiseFit fit = fit_noise(as_span(e), segments);
    NoiseFitOptions options;
    options.start = fit.model;
    const NoiseFit again = fit_noise(as_span(e), segments, options);
    CHECK(again.model.level_is_free() == fit.model.level_is_free());
    CHECK(again.evaluations <= 3 * (fit.model.order() + 2));
    CHECK(std::abs(again.minus_two_log_likelihood - fit.minus_two_log_likelihood) < 1e-3);
  }
}

TEST_CASE("scale and rows outside the segments do not matter") {
  Draws draws(760);
  const VectorXd e = draw_noise("pink", 300, draws);
  const NoiseFit fit = fit_noise(as_span(e), make_segments({300}), order(1));
  for (const double scale : {1e-200, 1e200}) {
    VectorXd wide = VectorXd::Constant(320, std::nan(""));
    wide.segment(10, 300) = scale * e;
    const NoiseFit scaled = fit_noise(as_span(wide), {{"", 10, 310}}, order(1));
    CHECK(scaled.model.d == Approx(fit.model.d).epsilon(1e-4));
    CHECK(scaled.model.sigma == Approx(scale * fit.model.sigma).epsilon(1e-6));
    CHECK(scaled.minus_two_log_likelihood ==
          Approx(fit.minus_two_log_likelihood +
                 2 * static_cast<double>(fit.informative_rows) * std::log(scale)));
  }
}

TEST_CASE("without differences the noise is white, of the root mean square") {
  const auto check = [](const VectorXd& e, const std::vector<Segment>& segments, double sigma) {
    const NoiseFit fit = fit_noise(as_span(e), segments);
    CHECK(fit.model.d == 0.0);
    CHECK(fit.model.order() == 0);
    CHECK_FALSE(fit.model.level_is_free());
    CHECK(fit.model.sigma == Approx(sigma));
    CHECK_FALSE(std::isnan(fit.minus_two_log_likelihood));
  };
  check(VectorXd::Zero(50), make_segments({30, 20}), 0.0);
  check(VectorXd::Constant(50, 0.1), make_segments({30, 20}), 0.1);
  check(VectorXd::Constant(1, -2.0), make_segments({1}), 2.0);
  Draws draws(770);
  const VectorXd e = draws.normal_matrix(40, 1);
  check(e, make_segments(std::vector<std::size_t>(40, 1)), e.norm() / std::sqrt(40.0));
  check(e.head(6), make_segments({6}), e.head(6).norm() / std::sqrt(6.0));
}

TEST_CASE("hardly any rows, and residuals that can be predicted, give finite models") {
  Draws draws(780);
  const VectorXd noise = draws.normal_matrix(400, 1);
  const auto check = [](const VectorXd& e, const std::vector<Segment>& segments,
                        const NoiseFitOptions& options) {
    const NoiseFit fit = fit_noise(as_span(e), segments, options);
    CHECK(std::isfinite(fit.model.d));
    CHECK(fit.model.phi.allFinite());
    CHECK(std::isfinite(fit.model.sigma));
    CHECK(fit.model.sigma > 0.0);
    MatrixXd column = e;
    Whitener(fit.model, segments).apply(column);
    CHECK(column.allFinite());
  };
  NoiseFitOptions many;
  many.max_order = 50;
  for (const std::size_t rows : {2U, 9U, 12U, 25U, 60U}) {
    check(noise.head(static_cast<Index>(rows)), make_segments({rows}), many);
    check(noise.head(static_cast<Index>(rows)), make_segments({rows}), order(20));
  }
  check(noise, make_segments(std::vector<std::size_t>(200, 2)), many);
  check(noise, make_segments({3, 1, 2, 200, 4, 190}), order(8));
  check(VectorXd::LinSpaced(100, -1, 1), make_segments({100}), {});
  check(VectorXd::LinSpaced(100, -1, 1).array().square(), make_segments({50, 50}), {});
  check(VectorXd::LinSpaced(400, 0, 60).array().sin(), make_segments({400}), {});
  VectorXd alternating(100);
  for (Index t = 0; t < 100; ++t) alternating[t] = t % 2 == 0 ? 1 : -1;
  check(alternating, make_segments({100}), {});
  VectorXd spike = VectorXd::Zero(100);
  spike[40] = 1;
  check(spike, make_segments({100}), {});
  check(noise.array() + 1e9, make_segments({400}), {});
  // What is left of a good fit to a log that was interpolated from a slower sensor.
  for (const double size : {1e-2, 1e-4, 1e-6, 1e-9}) {
    const VectorXd t = VectorXd::LinSpaced(400, 0, 30);
    check(t.array().sin() + 0.3 * (0.31 * t.array()).cos() + size * noise.array(),
          make_segments({400}), {});
    check(t.array().cube() + size * noise.array(), make_segments({250, 150}), order(8));
  }
  // A start of more coefficients than rows.
  NoiseFitOptions start;
  start.start = NoiseModel{0.1, VectorXd::Zero(5), 1.0};
  check(noise.head(12), make_segments({3, 4, 5}), start);
}

TEST_CASE("bad input is refused in words") {
  VectorXd e = VectorXd::Ones(20);
  e[7] = std::numeric_limits<double>::infinity();
  CHECK_THROWS_WITH_AS(fit_noise(as_span(e), make_segments({20})),
                       Contains("residual at row 7 is not finite"), Error);
  CHECK_THROWS_WITH_AS(fit_noise(as_span(e), {}), Contains("no segments"), Error);
  CHECK_THROWS_WITH_AS(fit_noise(as_span(e), {{"a", 10, 21}}), Contains("'a' ends at row 21"),
                       Error);
  CHECK_THROWS_WITH_AS(fit_noise(as_span(e), make_segments({5}), order(-1)), Contains("negative"),
                       Error);
  NoiseFitOptions options;
  options.start = NoiseModel{1.5, VectorXd(), 1.0};
  CHECK_THROWS_WITH_AS(fit_noise(as_span(e), make_segments({5}), options), Contains("d is 1.5"),
                       Error);
}

}  // namespace noise_fit_test
