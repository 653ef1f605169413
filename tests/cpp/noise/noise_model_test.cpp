// SPDX-License-Identifier: BSD-3-Clause
// Whitening, X' Sigma X and draws against dense covariances from closed forms: AR(1), AR(2),
// ARFIMA(0, d, 0), and for ARFIMA(1, d, 0) and free levels sums over long impulse responses.
#include "sepcal/noise_model.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "noises.hpp"
#include "numerics/decompositions.hpp"
#include "sepcal/error.hpp"

namespace noise_model_test {

using doctest::Approx;
using doctest::Contains;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Error;
using sepcal::NoiseModel;
using sepcal::Segment;
using sepcal::Whitener;
using sepcal::test::make_segments;

namespace {

VectorXd vector(std::initializer_list<double> values) {
  VectorXd v(static_cast<Index>(values.size()));
  Index i = 0;
  for (const double x : values) v[i++] = x;
  return v;
}

/// Block-diagonal Toeplitz covariance of segments from one autocovariance.
MatrixXd dense_covariance(const std::vector<std::size_t>& lengths, const VectorXd& gamma) {
  Index rows = 0;
  for (const std::size_t length : lengths) rows += static_cast<Index>(length);
  MatrixXd Sigma = MatrixXd::Zero(rows, rows);
  Index first = 0;
  for (const std::size_t length : lengths) {
    const auto n = static_cast<Index>(length);
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) Sigma(first + i, first + j) = gamma[std::abs(i - j)];
    }
    first += n;
  }
  return Sigma;
}

VectorXd ar1_autocovariance(double phi, Index lags) {
  return VectorXd::NullaryExpr(
      lags, [&](Index k) { return std::pow(phi, static_cast<double>(k)) / (1.0 - phi * phi); });
}

/// Box & Jenkins: gamma_0 = (1 - b) / ((1 + b) ((1 - b)^2 - a^2)), then Yule-Walker.
VectorXd ar2_autocovariance(double a, double b, Index lags) {
  VectorXd gamma(lags);
  gamma[0] = (1.0 - b) / ((1.0 + b) * ((1.0 - b) * (1.0 - b) - a * a));
  gamma[1] = a / (1.0 - b) * gamma[0];
  for (Index k = 2; k < lags; ++k) gamma[k] = a * gamma[k - 1] + b * gamma[k - 2];
  return gamma;
}

/// G(1-2d) G(k+d) / (G(d) G(1-d) G(k+1-d)), -0.5 < d < 0.5, d != 0.
VectorXd fractional_autocovariance(double d, Index lags) {
  return VectorXd::NullaryExpr(lags, [&](Index i) {
    const auto k = static_cast<double>(i);
    if (i == 0) return std::tgamma(1 - 2 * d) / std::pow(std::tgamma(1 - d), 2);
    return std::tgamma(1 - 2 * d) / (std::tgamma(d) * std::tgamma(1 - d)) *
           std::exp(std::lgamma(k + d) - std::lgamma(k + 1 - d));
  });
}

/// Of x = sum_i phi^i u_{t-i} for u with autocovariance gamma_u: a double sum, cut at 400 terms.
VectorXd ar1_of(double phi, double d, Index lags) {
  constexpr Index terms = 400;
  const VectorXd gamma_u = fractional_autocovariance(d, lags + terms);
  VectorXd gamma = VectorXd::Zero(lags);
  for (Index k = 0; k < lags; ++k) {
    for (Index m = -terms + 1; m < terms; ++m) {  // i - j = m: sum phi^{i+j} = phi^|m|/(1-phi^2)
      gamma[k] += std::pow(phi, std::abs(static_cast<double>(m))) / (1 - phi * phi) *
                  gamma_u[std::abs(k + m)];
    }
  }
  return gamma;
}

/// W'W = Sigma^-1 and the determinant, to `tolerance` of the largest element.
void check_whitener(const NoiseModel& model, const std::vector<std::size_t>& lengths,
                    const MatrixXd& Sigma, double tolerance) {
  const Whitener whitener(model, make_segments(lengths));
  REQUIRE(whitener.rows() == Sigma.rows());
  CHECK(whitener.informative_rows() == Sigma.rows());
  MatrixXd W = MatrixXd::Identity(Sigma.rows(), Sigma.rows());
  whitener.apply(W);
  const MatrixXd white = W * Sigma * W.transpose();
  CHECK((white - MatrixXd::Identity(white.rows(), white.rows())).cwiseAbs().maxCoeff() < tolerance);
  const MatrixXd L = Sigma.llt().matrixL();
  CHECK(std::abs(whitener.log_determinant() - 2 * L.diagonal().array().log().sum()) <
        tolerance * static_cast<double>(Sigma.rows()));
}

const std::vector<std::size_t> lengths{20, 1, 150, 2, 7};

/// Differences within segments; first rows have none.
MatrixXd difference_matrix(const std::vector<std::size_t>& of) {
  Index rows = 0;
  for (const std::size_t length : of) rows += static_cast<Index>(length);
  MatrixXd D = MatrixXd::Zero(rows - static_cast<Index>(of.size()), rows);
  Index first = 0;
  Index at = 0;
  for (const std::size_t length : of) {
    for (Index t = 1; t < static_cast<Index>(length); ++t, ++at) {
      D(at, first + t) = 1;
      D(at, first + t - 1) = -1;
    }
    first += static_cast<Index>(length);
  }
  return D;
}

}  // namespace

TEST_CASE("AR(1), AR(2): whitening is exact over segments of any length") {
  for (const double phi : {0.0, 0.5, 0.95, -0.8}) {
    CAPTURE(phi);
    const MatrixXd Sigma = 4.0 * dense_covariance(lengths, ar1_autocovariance(phi, 150));
    check_whitener({0.0, vector({phi}), 2.0}, lengths, Sigma, 1e-10);
  }
  const MatrixXd Sigma = dense_covariance(lengths, ar2_autocovariance(1.2, -0.5, 150));
  check_whitener({0.0, vector({1.2, -0.5}), 1.0}, lengths, Sigma, 1e-10);
}

TEST_CASE("ARFIMA(0, d, 0): whitening is exact") {
  for (const double d : {0.02, 0.3, 0.45}) {
    CAPTURE(d);
    const MatrixXd Sigma = 0.09 * dense_covariance(lengths, fractional_autocovariance(d, 150));
    check_whitener({d, VectorXd(), 0.3}, lengths, Sigma, 1e-8);
  }
  const std::vector<std::size_t> longer{900};
  check_whitener({0.3, VectorXd(), 1.0}, longer,
                 dense_covariance(longer, fractional_autocovariance(0.3, 900)), 1e-8);
}

TEST_CASE("ARFIMA(1, d, 0): whitening is exact") {
  for (const double phi : {0.6, -0.4}) {
    const MatrixXd Sigma = dense_covariance(lengths, ar1_of(phi, 0.3, 150));
    check_whitener({0.3, vector({phi}), 1.0}, lengths, Sigma, 1e-8);
  }
}

TEST_CASE("a free level: the differences are white, first rows are zero, a constant vanishes") {
  for (const double d : {0.55, 0.7, 0.95}) {
    CAPTURE(d);
    const NoiseModel model{d, VectorXd(), 1.5, true};
    const Whitener whitener(model, make_segments(lengths));
    CHECK(whitener.informative_rows() == 180 - 5);
    MatrixXd W = MatrixXd::Identity(180, 180);
    whitener.apply(W);
    std::vector<std::size_t> blocks;
    for (const std::size_t length : lengths) blocks.push_back(length - 1);
    const MatrixXd Gamma = 2.25 * dense_covariance(blocks, fractional_autocovariance(d - 1.0, 150));
    const MatrixXd D = difference_matrix(lengths);
    const MatrixXd precision = D.transpose() * Gamma.llt().solve(D);
    CHECK((W.transpose() * W - precision).cwiseAbs().maxCoeff() < 1e-8);
    const MatrixXd L = Gamma.llt().matrixL();
    CHECK(whitener.log_determinant() == Approx(2 * L.diagonal().array().log().sum()).epsilon(1e-8));
    for (const Index first : {0, 20, 21, 171, 173}) CHECK(W.row(first).cwiseAbs().maxCoeff() == 0);
    MatrixXd constant = MatrixXd::Constant(180, 1, 1e6);
    whitener.apply(constant);
    CHECK(constant.cwiseAbs().maxCoeff() == 0.0);
  }
}

TEST_CASE("a free level of white noise leaves what orthogonal contrasts leave") {
  const Whitener whitener({0.0, VectorXd(), 1.0, true}, make_segments({30, 5}));
  sepcal::test::Draws draws(511);
  MatrixXd x = draws.normal_matrix(35, 1);
  const double within = (x.topRows(30).array() - x.topRows(30).mean()).square().sum() +
                        (x.bottomRows(5).array() - x.bottomRows(5).mean()).square().sum();
  whitener.apply(x);
  CHECK(x.squaredNorm() == Approx(within).epsilon(1e-10));
  CHECK(whitener.log_determinant() == Approx(std::log(30.0 * 5.0)).epsilon(1e-10));  // det of DD'
}

TEST_CASE("whitening does not jump at d = 0.5") {
  // Just below, a first row counts 1 / sqrt(gamma_0): gamma_0 is near 1 / (pi (1 - 2d)).
  const double gap = 2e-6;
  sepcal::test::Draws draws(512);
  const MatrixXd x = draws.normal_matrix(300, 3);
  const auto segments = make_segments({280, 20});
  for (const VectorXd& phi : {VectorXd(), vector({0.4})}) {
    MatrixXd below = x;
    Whitener({0.5 - gap, phi, 1.0}, segments).apply(below);
    MatrixXd above = x;
    Whitener({0.5, phi, 1.0}, segments).apply(above);
    const MatrixXd change = below.transpose() * below - above.transpose() * above;
    CHECK(change.cwiseAbs().maxCoeff() < 3e-3);
    if (phi.size() == 0) CHECK((below - above).cwiseAbs().maxCoeff() < 3 * std::sqrt(7 * gap));
  }
}

TEST_CASE(
    "an AR with a long tail of past and future agrees with its dense covariance at 1300 rows") {
  // The regression of first rows on later ones is cut after 1024: a thousandth of one row's
  // variance.
  const MatrixXd Sigma = dense_covariance({1300}, ar1_of(0.6, 0.4, 1300));
  check_whitener({0.4, vector({0.6}), 1.0}, {1300}, Sigma, 1e-3);
}

TEST_CASE("X' Sigma X is the dense product, for few and many rows") {
  sepcal::test::Draws draws(513);
  for (const std::vector<std::size_t>& of : {lengths, std::vector<std::size_t>{400, 61}}) {
    const auto rows = static_cast<Index>(of.size() == 5 ? 180 : 461);
    const MatrixXd X = draws.normal_matrix(rows, 3);
    const auto check = [&](const NoiseModel& model, const MatrixXd& Sigma) {
      const MatrixXd expected = X.transpose() * Sigma * X;
      const MatrixXd product = sepcal::covariance_product(model, make_segments(of), X);
      CHECK((product - expected).cwiseAbs().maxCoeff() < 1e-8 * expected.cwiseAbs().maxCoeff());
    };
    check({0.0, VectorXd(), 3.0}, 9.0 * MatrixXd::Identity(rows, rows));
    check({0.0, vector({1.2, -0.5}), 2.0},
          4.0 * dense_covariance(of, ar2_autocovariance(1.2, -0.5, 400)));
    check({0.3, VectorXd(), 1.0}, dense_covariance(of, fractional_autocovariance(0.3, 400)));
    check({0.3, vector({0.6}), 1.0}, dense_covariance(of, ar1_of(0.6, 0.3, 400)));
  }
}

TEST_CASE("X' Sigma X of a free level is that of changes summed from n rows before the segment") {
  const std::vector<std::size_t> of{90, 1, 12};
  sepcal::test::Draws draws(514);
  const MatrixXd X = draws.normal_matrix(103, 2);
  for (const double d : {0.6, 0.8}) {
    MatrixXd Sigma = MatrixXd::Zero(103, 103);
    Index first = 0;
    for (const std::size_t length : of) {
      const auto n = static_cast<Index>(length);
      const VectorXd gamma = fractional_autocovariance(d - 1.0, 2 * n);
      const MatrixXd changes = dense_covariance({2 * length - 1}, gamma);
      MatrixXd S = MatrixXd::Ones(2 * n - 1, 2 * n - 1).triangularView<Eigen::Lower>();
      Sigma.block(first, first, n, n) = (S * changes * S.transpose()).bottomRightCorner(n, n);
      first += n;
    }
    const MatrixXd expected = X.transpose() * Sigma * X;
    const MatrixXd product = sepcal::covariance_product({d, VectorXd(), 1.0}, make_segments(of), X);
    CHECK((product - expected).cwiseAbs().maxCoeff() < 1e-8 * expected.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("draws have the covariance that X' Sigma X states; whitened they are white") {
  sepcal::test::Draws draws(515);
  const std::vector<std::size_t> of{100, 3, 40};
  const MatrixXd X = draws.normal_matrix(143, 4);
  for (const NoiseModel& model :
       {NoiseModel{0.0, vector({0.9}), 2.0}, NoiseModel{0.4, vector({0.5, -0.3}), 1.0},
        NoiseModel{0.5, VectorXd(), 1.0}, NoiseModel{0.9, vector({0.4}), 0.5},
        NoiseModel{0.2, vector({0.4}), 0.5, true}, NoiseModel{0.0, VectorXd(), 1.0, true}}) {
    CAPTURE(model.d);
    std::mt19937_64 generator(99);
    constexpr Index count = 4000;
    const MatrixXd noise = sepcal::simulate_noise(model, make_segments(of), count, generator);
    const MatrixXd projected = X.transpose() * noise;
    const MatrixXd expected = sepcal::covariance_product(model, make_segments(of), X);
    // Sample variance of a normal: relative standard deviation sqrt(2 / count); 4.5 of them.
    for (Index i = 0; i < 4; ++i) {
      CHECK(std::abs(projected.row(i).squaredNorm() / count / expected(i, i) - 1.0) <
            4.5 * std::sqrt(2.0 / count));
    }
    MatrixXd white = noise;
    const Whitener whitener(model, make_segments(of));
    whitener.apply(white);
    const auto n = static_cast<double>(whitener.informative_rows()) * count;
    CHECK(std::abs(white.squaredNorm() / n - 1.0) < 4.5 * std::sqrt(2.0 / n));
  }
}

TEST_CASE("rows are gathered segment after segment, and rows outside are not read") {
  const std::vector<double> e{1, 2, std::nan(""), 4, 5, 6};
  const VectorXd rows = sepcal::gather_rows(e, {{"", 0, 2}, {"", 4, 6}});
  CHECK(rows == vector({1, 2, 5, 6}));
  CHECK_THROWS_WITH_AS(sepcal::gather_rows(e, {{"a", 5, 7}}), Contains("'a' ends at row 7"), Error);
}

TEST_CASE("what is no noise model is refused") {
  const auto segments = make_segments({10});
  const auto refuse = [&](const NoiseModel& model, const char* says) {
    CHECK_THROWS_WITH_AS(Whitener(model, segments), Contains(says), Error);
  };
  refuse({1.0, VectorXd(), 1.0}, "d is 1");
  refuse({std::nan(""), VectorXd(), 1.0}, "must be in [0, 1)");
  refuse({0.0, vector({1.0}), 1.0}, "not stationary");
  refuse({0.0, vector({0.5, 0.6}), 1.0}, "not stationary");
  refuse({0.0, VectorXd(), 0.0}, "nothing to whiten");
  refuse({0.0, VectorXd(), -1.0}, "sigma");
  CHECK_THROWS_WITH_AS(Whitener({}, {{"a", 3, 3}}), Contains("'a' is empty"), Error);
  const Whitener whitener({}, segments);
  MatrixXd wrong = MatrixXd::Zero(9, 1);
  CHECK_THROWS_WITH_AS(whitener.apply(wrong), Contains("9 rows"), Error);
  CHECK_THROWS_WITH_AS(sepcal::covariance_product({}, segments, wrong), Contains("9 rows"), Error);
}

}  // namespace noise_model_test
