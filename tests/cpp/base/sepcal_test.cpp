// SPDX-License-Identifier: BSD-3-Clause
// One include is the whole engine.
#include "sepcal/sepcal.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace sepcal_test {

TEST_CASE("five lines fit a model to arrays") {
  std::vector<double> eta;
  std::vector<double> z;
  for (int k = 0; k < 50; ++k) {
    eta.push_back(0.1 * k);
    z.push_back(1.5 * std::cos(0.1 * k + 0.2) - 0.3);
  }
  sepcal::Record record;
  record.view("eta", eta).view("z", z);
  const sepcal::Fit fit = sepcal::fit(sepcal::ScalarExample1{}, record);

  CHECK(fit.status == sepcal::FitStatus::converged);
  CHECK(fit["a"].value == doctest::Approx(0.5).epsilon(1e-10));
  CHECK(fit["b"].value == doctest::Approx(0.2).epsilon(1e-10));
  CHECK(fit["c"].value == doctest::Approx(-0.3).epsilon(1e-10));
}

}  // namespace sepcal_test
