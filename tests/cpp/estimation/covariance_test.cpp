// SPDX-License-Identifier: BSD-3-Clause
// Standard errors on coloured residuals, against closed forms with dense matrices of their own.
#include "estimation/covariance.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "estimation/residual_colour.hpp"
#include "noises.hpp"
#include "numerics/decompositions.hpp"
#include "sepcal/fit.hpp"
#include "small_models.hpp"

namespace covariance_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::Record;
using sepcal::estimation::find_residual_noise;
using sepcal::estimation::find_restricted_noise;
using sepcal::estimation::is_white;
using sepcal::estimation::OutputNoise;
using sepcal::test::as_span;
using sepcal::test::draw_noise;
using sepcal::test::Draws;
using sepcal::test::Line;

namespace {

/// y = c, and z = s u + c: two outputs that share a parameter.
struct MeanAndLine {
  static constexpr std::array inputs{sepcal::Quantity{"u", "1"}};
  static constexpr std::array outputs{sepcal::Quantity{"y", "1"}, sepcal::Quantity{"z", "1"}};
  static constexpr std::array linear{sepcal::Quantity{"s", "1"}, sepcal::Quantity{"c", "1"}};
  static constexpr std::array<sepcal::Quantity, 0> nonlinear{};
  template <class U, class X>
  sepcal::Affine<X, 2, 2> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 0>&) const {
    sepcal::Affine<X, 2, 2> z;
    z.A << X(0.0), X(1.0), u[0], X(1.0);
    z.b << X(0.0), X(0.0);
    return z;
  }
};

std::vector<double> ramp(Index rows) {
  std::vector<double> u(static_cast<std::size_t>(rows));
  for (std::size_t k = 0; k < u.size(); ++k) u[k] = static_cast<double>(k) / 100.0;
  return u;
}

std::vector<double> as_column(const VectorXd& values) { return {values.begin(), values.end()}; }

/// Covariance of AR(1) noise over segments of the given lengths, innovations of variance 1.
MatrixXd ar1_covariance(double phi, const std::vector<Index>& lengths) {
  Index rows = 0;
  for (const Index length : lengths) rows += length;
  MatrixXd Sigma = MatrixXd::Zero(rows, rows);
  Index first = 0;
  for (const Index length : lengths) {
    for (Index i = 0; i < length; ++i) {
      for (Index j = 0; j < length; ++j) {
        Sigma(first + i, first + j) =
            std::pow(phi, static_cast<double>(std::abs(i - j))) / (1.0 - phi * phi);
      }
    }
    first += length;
  }
  return Sigma;
}

/// Of an autoregression of order 1, or of white noise beside one.
MatrixXd dense(const OutputNoise& noise, const std::vector<Index>& lengths) {
  REQUIRE(noise.stride == 1);
  if (const auto* model = std::get_if<sepcal::NoiseModel>(&noise.model)) {
    REQUIRE(model->d == 0.0);
    REQUIRE(model->order() == 1);
    return model->sigma * model->sigma * ar1_covariance(model->phi[0], lengths);
  }
  const auto& model = std::get<sepcal::noise::GaussMarkovNoise>(noise.model);
  const double phi = std::exp(-1.0 / model.rows);
  MatrixXd Sigma = (1.0 - model.white) * (1.0 - phi * phi) * ar1_covariance(phi, lengths);
  Sigma.diagonal().array() += model.white;
  return model.sigma * model.sigma * Sigma;
}

}  // namespace

TEST_CASE("the mean of AR(0.9) noise varies as the textbook says, the line's slope as well") {
  constexpr Index rows = 20'000;
  Draws draws(3);
  Record record;
  record.add("u", ramp(rows)).add("z", as_column(draw_noise("AR(0.9)", rows, draws)));
  FitOptions options;
  options.fix = {{"s", 0.0}};
  const Fit mean = sepcal::fit(Line{}, record, options);
  // var = [n (1 + p) / (1 - p) - 2 p (1 - p^n) / (1 - p)^2] / n^2 at unit variance.
  const double n = rows;
  const double expected = std::sqrt((19.0 * n - 2.0 * 0.9 / 0.01) / (n * n));
  CHECK(mean["c"].standard_error == Approx(expected).epsilon(0.08));
  CHECK(mean["c"].standard_error_white == Approx(1.0 / std::sqrt(n)).epsilon(0.08));

  const Fit line = sepcal::fit(Line{}, record);
  const VectorXd u = VectorXd::LinSpaced(rows, 0.0, (n - 1.0) / 100.0).array() - (n - 1.0) / 200.0;
  double variance = 0.0;  // u' Sigma u / (u'u)^2 by one pass: x_t = u_t + 0.9 x_{t-1}
  double x = 0.0;
  for (Index t = 0; t < rows; ++t) {
    variance += u[t] * (u[t] + 2.0 * 0.9 * x);
    x = u[t] + 0.9 * x;
  }
  CHECK(line["s"].standard_error == Approx(std::sqrt(variance) / u.squaredNorm()).epsilon(0.08));
}

TEST_CASE("the covariance is the sandwich with a dense Sigma of each output's noise") {
  const std::vector<Index> lengths{350, 250};
  constexpr Index rows = 600;
  Draws draws(31);  // whose AR(0.9) is fitted by an autoregression alone
  Record record;
  const VectorXd noise_y = draw_noise("AR(0.9)", rows, draws);
  const VectorXd noise_z = draw_noise("white", rows, draws);
  const std::vector<double> u = ramp(rows);
  record.add("u", u).add("y", as_column(noise_y)).add("z", as_column(noise_z));
  record.cut({{"a", 0, 350}, {"b", 350, 600}});
  for (const bool given : {false, true}) {
    CAPTURE(given);
    FitOptions options;
    if (given) options.noise = {{"y", 0.4}, {"z", 2.0}};
    const Fit fit = sepcal::fit(MeanAndLine{}, record, options);
    MatrixXd J_y = MatrixXd::Zero(rows, 2);
    J_y.col(1).setOnes();
    MatrixXd J_z = J_y;
    J_z.col(0) = Eigen::Map<const VectorXd>(u.data(), rows);
    const VectorXd e_y = noise_y - J_y * fit.values();
    const VectorXd e_z = noise_z - J_z * fit.values();
    const auto y = find_restricted_noise(e_y, J_y, record.segments());
    const auto z = find_restricted_noise(e_z, J_z, record.segments());
    REQUIRE(y);
    REQUIRE(z);
    REQUIRE(is_white(*z));
    // What z alone would leave, less its two parameters.
    const VectorXd left = e_z - J_z * J_z.householderQr().solve(e_z);
    const double sigma_z = std::sqrt(left.squaredNorm() / (rows - 2));
    const double r_y = std::pow(fit.noise[0].value, 2);
    const double r_z = std::pow(fit.noise[1].value, 2);
    const MatrixXd H = J_y.transpose() * J_y / r_y + J_z.transpose() * J_z / r_z;
    const MatrixXd middle = J_y.transpose() * dense(*y, lengths) * J_y / (r_y * r_y) +
                            sigma_z * sigma_z * J_z.transpose() * J_z / (r_z * r_z);
    const MatrixXd expected = H.inverse() * middle * H.inverse();
    CHECK((fit.covariance - expected).norm() < 1e-6 * expected.norm());
    CHECK((fit.covariance_white - H.inverse() * (given ? 1.0 : 1200.0 / 1198.0)).norm() <
          1e-8 * H.inverse().norm());
    CHECK(fit["c"].standard_error == Approx(std::sqrt(expected(1, 1))));
    CHECK(fit["c"].standard_error_white == Approx(std::sqrt(fit.covariance_white(1, 1))));
    CHECK(fit.correlation(0, 1) ==
          Approx(expected(0, 1) / std::sqrt(expected(0, 0) * expected(1, 1))));
    options.coloured_errors = false;
    const Fit plain = sepcal::fit(MeanAndLine{}, record, options);
    CHECK(plain.values() == fit.values());
    CHECK(plain.covariance == fit.covariance_white);
  }
}

TEST_CASE("parameters at a bound or fixed take no part") {
  Draws draws(4);
  Record record;
  record.add("u", ramp(500)).add("z", as_column(draw_noise("AR(0.9)", 500, draws)));
  FitOptions held;
  held.fix = {{"s", 0.5}};
  FitOptions bounded;
  bounded.bounds = {{"s", {0.5, 1.0}}};
  const Fit fixed = sepcal::fit(Line{}, record, held);
  const Fit stopped = sepcal::fit(Line{}, record, bounded);
  REQUIRE(stopped["s"].at_bound);
  CHECK(std::isnan(stopped["s"].standard_error));
  CHECK(std::isnan(fixed["s"].standard_error));
  CHECK(fixed["c"].standard_error > 2.0 * fixed["c"].standard_error_white);
  // The noise's sigma is found beside the columns of those that are free.
  CHECK(stopped["c"].standard_error == Approx(fixed["c"].standard_error).epsilon(1e-9));
}

TEST_CASE("what has no noise model is white") {
  Draws draws(5);
  for (const Index rows : {3, 29}) {
    Record record;
    record.add("u", ramp(rows)).add("z", as_column(draw_noise("AR(0.9)", rows, draws)));
    for (const bool given : {false, true}) {
      FitOptions options;
      if (given) options.noise = {{"z", 0.3}};
      const Fit fit = sepcal::fit(Line{}, record, options);
      CHECK(fit["s"].standard_error == Approx(fit["s"].standard_error_white));
      CHECK(std::isfinite(fit["s"].standard_error));
    }
  }
  Record exact;
  exact.add("u", ramp(100)).add("z", ramp(100));
  const Fit fit = sepcal::fit(Line{}, exact);
  CHECK(fit["s"].standard_error == fit["s"].standard_error_white);
  CHECK_FALSE(find_residual_noise(as_span(VectorXd::Zero(100)), {{"", 0, 100}}));
}

}  // namespace covariance_test
