// SPDX-License-Identifier: BSD-3-Clause
// The paper's two tutorial examples (Eqs. 21 and 33).
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/detail/compiled_models.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "simulated_records.hpp"

namespace scalar_examples_test {

using sepcal::ScalarExample1;
using sepcal::ScalarExample2;
using sepcal::Vec;

namespace {

template <class Model, int N2>
double predict(double eta, const Eigen::Vector2d& xi1, const Vec<double, N2>& xi2) {
  const auto z = Model{}.at(Vec<double, 1>(eta), xi2);
  return (z.A * xi1 + z.b)[0];
}

}  // namespace

TEST_CASE("example 1 is (1 + a) cos(eta + b) + c") {
  const double a = 0.4;
  const double b = -0.3;
  const double c = 2.0;
  for (const double eta : {-2.0, 0.0, 0.7, 3.0}) {
    const double z = predict<ScalarExample1, 1>(eta, {a, c}, Vec<double, 1>(b));
    CHECK(z == doctest::Approx((1 + a) * std::cos(eta + b) + c).epsilon(1e-14));
  }
}

TEST_CASE("example 2 is (1 + a) cos(eta (1 + b) + c) + d, with eta (1 + b) as in Eq. 33") {
  const double a = 0.4;
  const double b = -0.3;
  const double c = 2.0;
  const double d = -1.0;
  for (const double eta : {-2.0, 0.0, 0.7, 3.0}) {
    const double z = predict<ScalarExample2, 2>(eta, {a, d}, {b, c});
    CHECK(z == doctest::Approx((1 + a) * std::cos(eta * (1 + b) + c) + d).epsilon(1e-14));
  }
}

}  // namespace scalar_examples_test
