// SPDX-License-Identifier: BSD-3-Clause
// Weighted and iterated least squares against the batch's normal equations and a search by values.
#include "sepcal/states/least_squares.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "draws.hpp"

namespace least_squares_test {

using Eigen::Vector2d;
using sepcal::iterate_least_squares;
using sepcal::LeastSquaresRows;
using sepcal::LeastSquaresStatus;
using sepcal::test::Draws;

namespace {

/// y = a exp(-b t), two outputs with correlated errors: at t and at t + 0.5 s.
struct Decay {
  std::vector<double> times;
  std::vector<Vector2d> y;
  Eigen::Matrix2d W;

  explicit Decay(std::uint64_t seed) {
    Draws draws(seed);
    W << 4e-4, 2e-4, 2e-4, 9e-4;
    const Eigen::Matrix2d L = W.llt().matrixL();
    for (int k = 0; k < 25; ++k) {
      times.push_back(0.1 * k + 0.01 * draws.normal());
      y.emplace_back(expected(times.back(), {2.0, 0.7}) +
                     L * Vector2d(draws.normal(), draws.normal()));
    }
  }

  static Vector2d expected(double t, const Vector2d& p) {
    return {p[0] * std::exp(-p[1] * t), p[0] * std::exp(-p[1] * (t + 0.5))};
  }

  LeastSquaresRows<2, 2> operator()(int k, const Vector2d& p) const {
    const double t = times[static_cast<std::size_t>(k)];
    const Vector2d f = expected(t, p);
    Eigen::Matrix2d H;
    H << f[0] / p[0], -t * f[0], f[1] / p[0], -(t + 0.5) * f[1];
    return {y[static_cast<std::size_t>(k)] - f, H, W};
  }

  double cost(const Vector2d& p) const {  // S 4.5
    double sum = 0.0;
    for (std::size_t k = 0; k < y.size(); ++k) {
      const Vector2d z = y[k] - expected(times[k], p);
      sum += 0.5 * z.dot(W.inverse() * z);
    }
    return sum;
  }
};

}  // namespace

TEST_CASE("a linear problem is S 4.6 and 4.7 in one step") {
  Draws draws(1);
  constexpr int count = 15;
  std::vector<LeastSquaresRows<2, 3>> rows;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (int k = 0; k < count; ++k) {
    const Eigen::MatrixXd root = draws.normal_matrix(2, 4);
    rows.push_back({draws.normal_matrix(2, 1), draws.normal_matrix(2, 3), root * root.transpose()});
    const Eigen::MatrixXd weighted = rows.back().W.inverse() * rows.back().H;
    information += rows.back().H.transpose() * weighted;
    moment += weighted.transpose() * rows.back().z;
  }
  const auto sample = [&rows](int k, const Eigen::Vector3d& p) {
    LeastSquaresRows<2, 3> at = rows[static_cast<std::size_t>(k)];
    at.z -= at.H * p;
    return at;
  };
  const Eigen::Vector3d start(100.0, -20.0, 3.0);
  const auto fit = iterate_least_squares(sample, count, start);
  CHECK(fit.status == LeastSquaresStatus::converged);
  CHECK(fit.iterations <= 2);
  CHECK((fit.p - information.inverse() * moment).norm() < 1e-12);
  CHECK((fit.rows.covariance() - information.inverse()).norm() <
        1e-12 * information.inverse().norm());
  CHECK(fit.rows.count() == 2 * count);
}

TEST_CASE("a nonlinear problem ends where its cost is least, from near and from far") {
  const Decay decay(2);
  for (const Vector2d& start : {Vector2d(2.0, 0.7), Vector2d(1.0, 0.0), Vector2d(0.1, 4.0)}) {
    const auto fit = iterate_least_squares(decay, 25, start);
    CHECK(fit.status == LeastSquaresStatus::converged);
    CHECK(fit.cost == doctest::Approx(decay.cost(fit.p)).epsilon(1e-12));
    // A gradient by differences is zero beside a standard error, and the covariance is its inverse
    // curvature but for what the residuals add.
    const Eigen::Matrix2d P = fit.rows.covariance();
    for (int k = 0; k < 2; ++k) {
      const double sd = std::sqrt(P(k, k));
      Vector2d h = Vector2d::Zero();
      h[k] = 1e-3 * sd;
      CHECK(std::abs(decay.cost(fit.p + h) - decay.cost(fit.p - h)) / 2e-3 < 1e-5);
    }
    CHECK(
        (fit.p - Vector2d(2.0, 0.7)).cwiseAbs().cwiseQuotient(P.diagonal().cwiseSqrt()).maxCoeff() <
        4.0);
  }
}

TEST_CASE("statuses: too few iterations, a parameter that nothing tells of, bad numbers") {
  const Decay decay(3);
  CHECK(iterate_least_squares(decay, 25, Vector2d(0.1, 4.0), {.iterations = 2}).status ==
        LeastSquaresStatus::not_converged);
  const auto blind = [&decay](int k, const Vector2d& p) {
    auto at = decay(k, p);
    at.H.col(1).setZero();
    return at;
  };
  CHECK(iterate_least_squares(blind, 25, Vector2d(2.0, 0.7)).status ==
        LeastSquaresStatus::not_determined);
  CHECK(iterate_least_squares(decay, 25, Vector2d(0.0, 0.7)).status ==
        LeastSquaresStatus::refused);  // 0 / 0
  CHECK(iterate_least_squares(decay, 0, Vector2d(2.0, 0.7)).status ==
        LeastSquaresStatus::not_determined);
}

TEST_CASE("in float it converges to what rounds") {
  const Decay decay(3);
  const auto in_float = [&decay](int k, const Eigen::Vector2f& p) {
    const auto rows = decay(k, p.cast<double>());
    return LeastSquaresRows<2, 2, float>{rows.z.cast<float>(), rows.H.cast<float>(),
                                         rows.W.cast<float>()};
  };
  const auto fit = iterate_least_squares(decay, 25, Vector2d(1.0, 1.0));
  const auto coarse = iterate_least_squares(in_float, 25, Eigen::Vector2f(1.0F, 1.0F));
  CHECK(coarse.status == LeastSquaresStatus::converged);
  CHECK((coarse.p.cast<double>() - fit.p).norm() < 1e-5);
}

TEST_CASE("a step to where the model is no number is shortened, not taken for missing rows") {
  using One = Eigen::Matrix<double, 1, 1>;
  const auto logarithm = [](int, const One& p) {
    return LeastSquaresRows<1, 1>{One(-5.0 - std::log(p[0])), One(1.0 / p[0]), One(1.0)};
  };
  const auto fit = iterate_least_squares(logarithm, 1, One(0.1));
  CHECK(fit.status == LeastSquaresStatus::converged);
  CHECK(fit.p[0] == doctest::Approx(std::exp(-5.0)).epsilon(1e-9));
}

}  // namespace least_squares_test
