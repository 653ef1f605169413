// SPDX-License-Identifier: BSD-3-Clause
// Burg's lattice and predictions, against loops over single rows.
#include "noise/autoregression.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "noises.hpp"

namespace autoregression_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::VectorXd;
using namespace sepcal;
using noise::BurgFit;

namespace {

/// Partial autocorrelations, row by row.
VectorXd burg(const VectorXd& y, const std::vector<Index>& lengths, Index orders) {
  VectorXd f = y;
  VectorXd b = y;
  VectorXd partial(orders);
  for (Index k = 0; k < orders; ++k) {
    double product = 0.0;
    double power = 0.0;
    Index first = 0;
    for (const Index length : lengths) {
      for (Index t = first + k + 1; t < first + length; ++t) {
        product += f[t] * b[t - 1];
        power += f[t] * f[t] + b[t - 1] * b[t - 1];
      }
      first += length;
    }
    const double r = partial[k] = 2.0 * product / power;
    first = 0;
    for (const Index length : lengths) {
      for (Index t = first + length - 1; t > first + k; --t) {
        const double forward = f[t] - r * b[t - 1];
        b[t] = b[t - 1] - r * f[t];
        f[t] = forward;
      }
      first += length;
    }
  }
  return partial;
}

void check(const VectorXd& y, const std::vector<Index>& lengths) {
  const int orders = 8;
  const VectorXd expected = burg(y, lengths, orders);
  const BurgFit found = noise::fit_burg(y, lengths, orders);
  CHECK((found.partial - expected).cwiseAbs().maxCoeff() < 1e-8);
  const BurgFit first = noise::fit_burg(y, lengths, 2);
  CHECK((first.criterion - found.criterion.head(3)).cwiseAbs().maxCoeff() <
        1e-9 * std::abs(found.criterion[0]) + 1e-6);
}

}  // namespace

TEST_CASE("Burg's lattice of few rows, of many, and of rows that are all but predicted") {
  test::Draws draws(5);
  check(test::draw_autoregression(0.7, 90, draws), {40, 3, 47});
  check(test::draw_autoregression(0.7, 3003, draws), {1400, 1603});
  VectorXd swing = VectorXd::LinSpaced(2000, 0.0, 300.0).array().sin();
  swing += 1e-4 * test::draw_autoregression(0.0, 2000, draws);
  check(swing, {2000});
}

TEST_CASE("what is predicted is subtracted, whatever the number of rows") {
  test::Draws draws(6);
  const VectorXd phi = Eigen::Vector3d(0.5, -0.3, 0.1);
  for (const Index rows : {2, 3, 4, 35, 36, 100}) {
    const VectorXd x = test::draw_autoregression(0.3, rows, draws);
    VectorXd left = x;
    noise::subtract_predictions(phi, left);
    for (Index t = 0; t < rows; ++t) {
      const double predicted = t < 3 ? 0.0 : phi.dot(x.segment(t - 3, 3).reverse());
      CHECK(left[t] == Approx(x[t] - predicted).epsilon(1e-14));
    }
  }
}

}  // namespace autoregression_test
