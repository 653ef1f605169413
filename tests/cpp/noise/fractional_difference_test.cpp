// SPDX-License-Identifier: BSD-3-Clause
// Fractional differences by exponentials against the sum that they stand for, term by term.
#include "noise/fractional_difference.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "draws.hpp"

namespace fractional_difference_test {

using Eigen::Index;
using Eigen::VectorXd;
using namespace sepcal::test;
using sepcal::noise::FractionalDifference;

namespace {

VectorXd sum_of_terms(double d, const VectorXd& x) {
  VectorXd coefficients(x.size());
  coefficients[0] = 1.0;
  for (Index k = 1; k < x.size(); ++k) {
    coefficients[k] =
        coefficients[k - 1] * (static_cast<double>(k - 1) - d) / static_cast<double>(k);
  }
  VectorXd y(x.size());
  for (Index t = 0; t < x.size(); ++t) {
    y[t] = coefficients.head(t + 1).dot(x.head(t + 1).reverse());
  }
  return y;
}

}  // namespace

TEST_CASE("exponentials add up to the coefficients, however many rows there are") {
  Draws draws(3);
  for (const Index rows : {100, 1000, 2048, 2049, 6000}) {
    const VectorXd x = draws.normal_matrix(rows, 1);
    for (const double d : {0.001, 0.03, 0.15, 0.45, 0.8, 0.999}) {
      CAPTURE(rows);
      CAPTURE(d);
      const double largest = x.cwiseAbs().maxCoeff();
      VectorXd y = x;
      FractionalDifference(d, rows).apply(y);
      CHECK((y - sum_of_terms(d, x)).cwiseAbs().maxCoeff() < 1e-10 * largest);
      y = x;
      FractionalDifference(d - 1.0, rows).apply(y);
      const double error = (y - sum_of_terms(d - 1.0, x)).cwiseAbs().maxCoeff();
      CHECK(error < 1e-11 * static_cast<double>(rows) * largest);
    }
  }
}

TEST_CASE("the last coefficients of a long record are exact, though slow decays were merged") {
  constexpr Index rows = 200'000;
  for (const double d : {0.15, 0.45, 0.9}) {
    CAPTURE(d);
    VectorXd y = VectorXd::Unit(rows, 0);
    FractionalDifference(d, rows).apply(y);
    const VectorXd expected = sum_of_terms(d, VectorXd::Unit(3000, 0));
    CHECK((y.head(3000) - expected).cwiseAbs().sum() < 1e-9);
    // pi_k = -d k^(-1-d) (1 + d (1 + d) / (2 k) + O(k^-2)) / G(1-d), G the gamma function.
    double sum = 0.0;
    for (Index k = 3000; k < rows; ++k) {
      const auto at = static_cast<double>(k);
      const double asymptotic =
          -d * std::pow(at, -1.0 - d) * (1.0 + d * (1.0 + d) / (2.0 * at)) / std::tgamma(1.0 - d);
      sum += std::abs(y[k] - asymptotic);
    }
    CHECK(sum < 1e-7 * d);
  }
}

}  // namespace fractional_difference_test
