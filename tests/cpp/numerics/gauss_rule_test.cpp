// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/gauss_rule.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace gauss_rule_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::VectorXd;
using sepcal::numerics::gauss_rule;
using sepcal::numerics::GaussRule;

TEST_CASE("two points that stand for three: one deviation on either side of the mean") {
  const GaussRule rule = gauss_rule(VectorXd::LinSpaced(3, 0.0, 2.0), VectorXd::Ones(3), 2);
  CHECK(rule.nodes[0] == Approx(1.0 - std::sqrt(2.0 / 3.0)));
  CHECK(rule.nodes[1] == Approx(1.0 + std::sqrt(2.0 / 3.0)));
  CHECK(rule.weights[0] == Approx(1.5));
  CHECK(rule.weights[1] == Approx(1.5));
}

TEST_CASE("sums of powers are the points' own up to degree 2 count - 1, and not beyond") {
  VectorXd x(40);  // of very different sizes, as exponents of slow decays are
  for (Index i = 0; i < x.size(); ++i) x[i] = std::exp(-0.4 * static_cast<double>(i));
  const VectorXd w = -x.array().pow(1.3);
  constexpr Index count = 5;
  const GaussRule rule = gauss_rule(x, w, count);
  CHECK(rule.nodes.minCoeff() > x.minCoeff());
  CHECK(rule.nodes.maxCoeff() < x.maxCoeff());
  const auto sum = [](const VectorXd& points, const VectorXd& weights, Index degree) {
    return weights.dot(points.array().pow(static_cast<double>(degree)).matrix());
  };
  for (Index degree = 0; degree < 2 * count; ++degree) {
    CAPTURE(degree);
    CHECK(sum(rule.nodes, rule.weights, degree) == Approx(sum(x, w, degree)).epsilon(1e-13));
  }
  const double beyond = sum(x, w, 2 * count) / sum(rule.nodes, rule.weights, 2 * count);
  CHECK(beyond - 1.0 > 1e-9);
}

}  // namespace gauss_rule_test
