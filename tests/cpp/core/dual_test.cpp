// SPDX-License-Identifier: BSD-3-Clause
// Flight's dual numbers against Ceres' Jets, function by function and derivative by derivative.
#include "sepcal/detail/dual.hpp"

#include <ceres/jet.h>
#include <doctest/doctest.h>

#include <cmath>
#include <string>

namespace dual_test {

using doctest::Approx;
using sepcal::Dual;
using Jet = ceres::Jet<double, 2>;

namespace {

/// Calls `check` with each function's name and its value of x and y, numbers of one kind.
template <class Number, class Check>
void with_functions(const Number& x, const Number& y, const Check& check) {
  using namespace std;  // NOLINT(google-build-using-namespace): functions of doubles, beside ADL's
  check("x + y", x + y);
  check("x - y", x - y);
  check("x y", x * y);
  check("x / y", x / y);
  check("-x", -x);
  check("x + 2", x + 2.0);
  check("2 + x", 2.0 + x);
  check("x - 2", x - 2.0);
  check("2 - x", 2.0 - x);
  check("2 x", 2.0 * x);
  check("x 2", x * 2.0);
  check("x / 2", x / 2.0);
  check("2 / x", 2.0 / x);
  check("abs", abs(-x));
  check("sqrt", sqrt(x * y));
  check("cbrt", cbrt(x * y));
  check("exp", exp(x - y));
  check("exp2", exp2(x - y));
  check("expm1", expm1(x - y));
  check("log", log(x * y));
  check("log2", log2(x * y));
  check("log10", log10(x * y));
  check("log1p", log1p(x * y));
  check("cos", cos(x - y));
  check("sin", sin(x - y));
  check("tan", tan(x - y));
  check("acos", acos(0.25 * x * y));
  check("asin", asin(0.25 * x * y));
  check("atan", atan(x * y));
  check("cosh", cosh(x - y));
  check("sinh", sinh(x - y));
  check("tanh", tanh(x - y));
  check("erf", erf(x - y));
  check("atan2", atan2(x, -y));
  check("hypot", hypot(x, y));
  check("pow", pow(x, 2.5));
  check("fmax", fmax(x, y));
  check("fmin", fmin(x, y));
}

struct Seen {
  std::string name;
  double value;
  double by_x;
  double by_y;
};

}  // namespace

TEST_CASE("every function has the value and the derivatives that Ceres' Jets have") {
  const double points[][2] = {{0.7, 1.3}, {1.9, 0.4}, {0.01, 2.5}};
  for (const auto& at : points) {
    std::vector<Seen> jets;
    with_functions(Jet(at[0], 0), Jet(at[1], 1), [&](const char* name, const Jet& f) {
      jets.push_back({name, f.a, f.v[0], f.v[1]});
    });
    std::size_t next = 0;
    with_functions(Dual<double, 2>(at[0], 0), Dual<double, 2>(at[1], 1),
                   [&](const char* name, const Dual<double, 2>& f) {
                     const Seen& jet = jets.at(next++);
                     CAPTURE(name);
                     CHECK(jet.name == name);
                     CHECK(f.value() == Approx(jet.value).epsilon(1e-15));
                     CHECK(f.slope(0) == Approx(jet.by_x).epsilon(4e-15));
                     CHECK(f.slope(1) == Approx(jet.by_y).epsilon(4e-15));
                   });
    CHECK(next == jets.size());
  }
}

TEST_CASE("in float the derivatives are those of double, to float's digits") {
  std::vector<Seen> doubles;
  with_functions(Dual<double, 2>(0.7, 0), Dual<double, 2>(1.3, 1),
                 [&](const char* name, const Dual<double, 2>& f) {
                   doubles.push_back({name, f.value(), f.slope(0), f.slope(1)});
                 });
  std::size_t next = 0;
  with_functions(Dual<float, 2>(0.7F, 0), Dual<float, 2>(1.3F, 1),
                 [&](const char* name, const Dual<float, 2>& f) {
                   const Seen& expected = doubles.at(next++);
                   CAPTURE(name);
                   CHECK(f.value() == Approx(expected.value).epsilon(2e-6));
                   CHECK(f.slope(0) == Approx(expected.by_x).epsilon(4e-6));
                   CHECK(f.slope(1) == Approx(expected.by_y).epsilon(4e-6));
                 });
}

TEST_CASE("a variable that is none of them has no derivative, and comparisons are of values") {
  const Dual<double, 2> none(3.0, 2);
  CHECK(none.slope(0) == 0.0);
  CHECK(none.slope(1) == 0.0);
  const Dual<double, 2> x(1.0, 0);
  const Dual<double, 2> y(1.0, 1);
  CHECK(x == y);
  CHECK(x < none);
  CHECK(x >= 1.0);
  CHECK_FALSE(isnan(x));
  CHECK(isnan(Dual<double, 2>(std::nan(""))));
  CHECK_FALSE(isfinite(x / 0.0));
}

TEST_CASE("matrices of them multiply, with numbers of their own kind beside them") {
  Eigen::Matrix<Dual<double, 1>, 2, 2> A;
  const Dual<double, 1> t(0.4, 0);
  A << cos(t), -sin(t), sin(t), cos(t);
  const Eigen::Matrix<Dual<double, 1>, 2, 2> identity = A * A.transpose();
  CHECK(identity(0, 0).value() == Approx(1.0));
  CHECK(identity(0, 0).slope(0) == Approx(0.0));
  CHECK(identity(0, 1).slope(0) == Approx(0.0));
  const Eigen::Matrix<Dual<double, 1>, 2, 1> turned = A * Eigen::Vector2d(1.0, 2.0);
  CHECK(turned[0].slope(0) == Approx(-std::sin(0.4) - 2.0 * std::cos(0.4)));
}

}  // namespace dual_test
