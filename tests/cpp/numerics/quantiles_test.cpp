// SPDX-License-Identifier: BSD-3-Clause
// Quantiles against SciPy 1.14's scipy.stats.norm and scipy.stats.t, ppf(0.5 + level / 2).
#include "numerics/quantiles.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "sepcal/error.hpp"

namespace quantiles_test {

using doctest::Approx;
using sepcal::numerics::normal_reach;
using sepcal::numerics::student_reach;

TEST_CASE("the normal's quantiles are SciPy's") {
  CHECK(normal_reach(0.5) == Approx(0.6744897501960817).epsilon(1e-13));
  CHECK(normal_reach(0.95) == Approx(1.959963984540054).epsilon(1e-13));
  CHECK(normal_reach(0.9999) == Approx(3.8905918864131204).epsilon(1e-12));
}

TEST_CASE("Student's quantiles are SciPy's, with few degrees of freedom and with many") {
  struct Expected {
    double level, freedom, t;
  };
  for (const auto& [level, freedom, t] : {Expected{0.5, 1, 1.0000000000000002},
                                          {0.5, 97, 0.6770274185620064},
                                          {0.95, 1, 12.706204736174694},
                                          {0.95, 2, 4.302652729749462},
                                          {0.95, 3.5, 2.9400886379827282},
                                          {0.95, 8, 2.306004135204166},
                                          {0.95, 97, 1.9847231860139845},
                                          {0.95, 999, 1.9623414611334493},
                                          {0.95, 1001, 1.9623367052808798},
                                          {0.95, 22203, 1.9600708348917126},
                                          {0.95, 3e6, 1.9599647752974443},
                                          {0.9999, 1, 6366.197671316637},
                                          {0.9999, 8, 7.1200038827346495},
                                          {0.9999, 1001, 3.9063279440312937}}) {
    CAPTURE(level);
    CAPTURE(freedom);
    CHECK(student_reach(level, freedom) == Approx(t).epsilon(1e-11));
  }
}

TEST_CASE("without a degree of freedom nothing is known") {
  CHECK(std::isinf(student_reach(0.95, 0)));
  CHECK(std::isinf(student_reach(0.95, -3)));
}

TEST_CASE("a level must lie between 0 and 1") {
  for (const double level : {0.0, 1.0, 95.0, -0.5, std::nan("")}) {
    CHECK_THROWS_WITH_AS(normal_reach(level), doctest::Contains("between 0 and 1"), sepcal::Error);
    CHECK_THROWS_AS(student_reach(level, 5), sepcal::Error);
  }
}

}  // namespace quantiles_test
