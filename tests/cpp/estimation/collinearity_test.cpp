// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/collinearity.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <cmath>

#include "sepcal/error.hpp"

namespace collinearity_test {

using namespace sepcal;

namespace {

Fit fit_of_two(double r) {
  Fit fit;
  fit.parameters = {{.name = "a", .unit = "", .value = 1.0},
                    {.name = "b", .unit = "", .value = -2.0}};
  fit.correlation = (Eigen::Matrix2d() << 1.0, r, r, 1.0).finished();
  fit.covariance = (Eigen::Matrix2d() << 4.0, 6.0 * r, 6.0 * r, 9.0).finished();
  return fit;
}

}  // namespace

TEST_CASE("the collinearity of two estimates is that of their correlation") {
  for (const double r : {-0.99, 0.2, 0.95}) {
    CAPTURE(r);
    const Collinearity found = find_collinearity(fit_of_two(r));
    CHECK(found.pairs.size() == (std::abs(r) > 0.9 ? 1U : 0U));
    CHECK(found.condition_indices[0] == doctest::Approx(1.0));
    const double expected = std::sqrt((1.0 + std::abs(r)) / (1.0 - std::abs(r)));
    CHECK(found.condition_indices[1] == doctest::Approx(expected));
    // 1 / (1 - |r|) beside 1 / (1 + |r|), for both alike.
    const double share = 0.5 * (1.0 + std::abs(r));
    for (int k = 0; k < 2; ++k) CHECK(found.variance_proportions(1, k) == doctest::Approx(share));
  }
}

TEST_CASE("estimates that are one have an infinite condition index") {
  const Collinearity found = find_collinearity(fit_of_two(1.0));
  CHECK(std::isinf(found.condition_indices[1]));
  CHECK(std::isnan(found.variance_proportions(0, 0)));
  CHECK(found.pairs.size() == 1U);
}

TEST_CASE("an ellipse lies at the quantile of chi-squared with two degrees of freedom") {
  const Fit fit = fit_of_two(0.6);
  const Eigen::MatrixXd around = confidence_ellipse(fit, "b", "a", 0.95, 25);
  const Eigen::Matrix2d P = (Eigen::Matrix2d() << 9.0, 3.6, 3.6, 4.0).finished();
  for (Eigen::Index i = 0; i < around.rows(); ++i) {
    const Eigen::Vector2d off = around.row(i).transpose() - Eigen::Vector2d(-2.0, 1.0);
    CHECK(off.dot(P.inverse() * off) == doctest::Approx(5.991464547107979));
  }
  CHECK_THROWS_AS(confidence_ellipse(fit, "a", "a"), Error);
  CHECK_THROWS_AS(confidence_ellipse(fit, "a", "c"), Error);
}

}  // namespace collinearity_test
