// SPDX-License-Identifier: BSD-3-Clause
// The share of a chosen estimate: against scipy.integrate.quad of the same likelihood, and by what
// it is for, that chosen estimates are right in the mean.
#include "numerics/selection.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <random>

namespace selection_test {

using doctest::Approx;
using sepcal::numerics::share_after_selection;

TEST_CASE("the share of a chosen estimate is the integral's") {
  struct Case {
    double size;
    double least;
    double share;
  };
  for (const Case& chosen :
       {Case{3.3, 3.24, 0.738665058}, Case{4.0, 3.24, 0.856628661}, Case{5.0, 3.24, 0.968138753},
        Case{6.5, 3.24, 0.998011987}, Case{2.5, 1.96, 0.838245008}}) {
    CHECK(share_after_selection(chosen.size, chosen.least) == Approx(chosen.share).epsilon(1e-6));
  }
  CHECK(share_after_selection(40.0, 3.24) == 1.0);
}

TEST_CASE("estimates told only where they are large are right in the mean with their share") {
  constexpr double least = 3.24;  // of one among 42 at 5 %
  constexpr int draws = 20'000;   // of 60 % that are told: a mean to 0.3 % of itself
  std::mt19937_64 generator(11);
  std::normal_distribution<double> normal;
  for (const double truth : {3.5, 4.0, 5.0}) {
    double told = 0.0;
    double plain = 0.0;
    double shared = 0.0;
    for (int i = 0; i < draws; ++i) {
      const double size = truth + normal(generator);
      if (size < least) continue;
      told += 1.0;
      plain += size / truth;
      shared += size / truth * share_after_selection(size, least);
    }
    CAPTURE(truth);
    CHECK(std::abs(shared / told - 1.0) < 0.05);
    if (truth < 4.5) CHECK(plain / told > 1.08);
  }
}

}  // namespace selection_test
