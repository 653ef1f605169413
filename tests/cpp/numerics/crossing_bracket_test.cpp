// SPDX-License-Identifier: BSD-3-Clause
// Crossings of functions whose place is known, smooth, with a kink and with a jump.
#include "numerics/crossing_bracket.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace crossing_bracket_test {

using doctest::Approx;
using sepcal::numerics::CrossingBracket;

namespace {

struct Search {
  double at = 0.0;
  int evaluations = 0;
};

Search search(const std::function<double(double)>& f, double height, double first) {
  CrossingBracket bracket(height, first);
  double distance = first;
  for (int i = 1; i <= 100; ++i) {
    const double value = f(distance);
    bracket.add(distance, value);
    if (std::abs(value - height) <= 1e-12 || (bracket.closed() && bracket.width() <= 1e-12)) {
      return {distance, i};
    }
    distance = bracket.next();
  }
  return {};
}

}  // namespace

TEST_CASE("a straight line is crossed in two looks, from either side") {
  const Search from_below = search([](double x) { return 2.0 * x; }, 3.0, 1.0);
  CHECK(from_below.at == Approx(1.5).epsilon(1e-14));
  CHECK(from_below.evaluations == 2);
  CHECK(search([](double x) { return 2.0 * x; }, 3.0, 4.0).evaluations == 2);
}

TEST_CASE("a curve and a kink") {
  const Search curve = search([](double x) { return x * x; }, 2.0, 0.1);
  CHECK(curve.at == Approx(std::sqrt(2.0)).epsilon(1e-12));
  CHECK(curve.evaluations < 15);
  // Slope 0.01 up to 5, then 1: 0.05 at 5 and 2 at 5 + 1.95.
  const auto kink = [](double x) { return 0.01 * x + 0.99 * std::max(0.0, x - 5.0); };
  CHECK(search(kink, 2.0, 1.0).at == Approx(6.95).epsilon(1e-12));
}

TEST_CASE("a jump is narrowed to where it is") {
  const Search jump = search([](double x) { return x < 3.25 ? 0.1 * x : 50.0; }, 2.0, 1.0);
  CHECK(jump.at == Approx(3.25).epsilon(1e-11));
}

TEST_CASE("a value far above what lies below promises is a leap, and may be taken back") {
  CrossingBracket bracket(2.0, 1.0);
  bracket.add(0.5, 1.0);
  bracket.add(0.75, 1.5);
  CHECK_FALSE(bracket.leaps_to(1.25, 2.5));
  CHECK_FALSE(bracket.leaps_to(0.8, 1.9));  // below the height nothing leaps
  CHECK(bracket.leaps_to(1.25, 12.0));
  bracket.add(1.25, 12.0);
  REQUIRE(bracket.closed());
  CHECK(bracket.leaps());
  bracket.reopen(1.75);
  CHECK_FALSE(bracket.closed());
  CHECK(bracket.low() == 1.25);
  CHECK(bracket.next() == Approx(1.75));  // the slope is 0.5 now
}

}  // namespace crossing_bracket_test
