// SPDX-License-Identifier: BSD-3-Clause
// How often a fit passes over its record: what its time is made of, without a clock.
#include <doctest/doctest.h>

#include <algorithm>

#include "sepcal/fit.hpp"
#include "simulated_records.hpp"

namespace passes_test {

using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::Passes;
using sepcal::test::Simulated;

namespace {

void check_at_most(const Passes& passes, const Passes& most) {
  CHECK(passes.values <= most.values);
  CHECK(passes.tangents <= most.tangents);
}

}  // namespace

TEST_CASE("one minimum of a probe is found, told from others and refined in a few passes") {
  const Simulated flight = sepcal::test::simulate_five_hole(5'000);
  FitOptions options;
  options.threads = 1;
  const Fit fit = sepcal::fit(*flight.model, flight.record, options);
  REQUIRE(fit.stage_one.minima.size() == 1);
  check_at_most(fit.stage_one.passes, {16, 14});
  check_at_most(fit.stage_two_passes, {4, 8});
  check_at_most(fit.last_passes, {4, 4});

  options.noise = {{"vn", 0.15}, {"ve", 0.15}, {"vd", 0.15}};
  check_at_most(sepcal::fit(*flight.model, flight.record, options).stage_two_passes, {3, 3});
}

TEST_CASE("from a start near the minimum a fit makes as many passes as steps") {
  const Simulated flight = sepcal::test::simulate_five_hole(5'000);
  FitOptions options;
  options.threads = 1;
  for (const sepcal::Parameter& parameter :
       sepcal::fit(*flight.model, flight.record, options).parameters) {
    options.start[parameter.name] = parameter.value + parameter.standard_error;
  }
  std::erase_if(options.start, [&](const auto& entry) {
    const auto& nonlinear = flight.model->tables().nonlinear;
    return std::ranges::find(nonlinear, entry.first, &sepcal::Variable::name) == nonlinear.end();
  });
  const Fit fit = sepcal::fit(*flight.model, flight.record, options);
  CHECK(fit.stage_one.passes.tangents == 0);
  check_at_most(fit.stage_two_passes, {6, 10});
}

TEST_CASE("a hundred rows of a scalar example need no more") {
  const Simulated flight = sepcal::test::simulate_scalar_1(100);
  FitOptions options;
  options.threads = 1;
  const Fit fit = sepcal::fit(*flight.model, flight.record, options);
  check_at_most(fit.stage_one.passes, {20, 16});
  check_at_most(fit.stage_two_passes, {3, 3});
}

}  // namespace passes_test
