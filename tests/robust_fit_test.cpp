// SPDX-License-Identifier: BSD-3-Clause
// Fits that forgive outliers, as statistics. Seeds are fixed; of 300 flights a 95 % interval covers
// 285 +- 3.8, so that each bound below fails a correct build by chance once in 20,000.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "sepcal/fit.hpp"
#include "sepcal/models/scalar_examples.hpp"
#include "simulated_records.hpp"

using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::Loss;
using sepcal::Record;

namespace {

constexpr int flights = 300;
constexpr std::array truth{0.3, 0.5, 0.2};  // a, c, b

/// Scalar example 1, 200 rows, noise of 0.1; every twentieth reading is off by 30 of these, up or,
/// where `both_ways`, up or down.
Record simulate_with_outliers(std::uint64_t seed, bool both_ways) {
  sepcal::test::Draws draws(seed);
  std::vector<double> eta = draws.uniform_column(200, 0.0, 2.0 * std::numbers::pi);
  std::vector<double> z;
  for (std::size_t k = 0; k < eta.size(); ++k) {
    double reading = (1.0 + truth[0]) * std::cos(eta[k] + truth[2]) + truth[1];
    reading += 0.1 * draws.normal();
    const double sign = both_ways && draws.uniform(-1.0, 1.0) < 0.0 ? -1.0 : 1.0;
    if (k % 20 == 7) reading += 3.0 * sign;
    z.push_back(reading);
  }
  Record record;
  record.add("eta", std::move(eta)).add("z", std::move(z));
  return record;
}

/// Flights in which each parameter (a, c, b) lies within its interval of `errors` standard errors.
struct Coverage {
  std::array<int, 3> within{};
  int all_three = 0;
};

Coverage count(Loss loss, bool both_ways, double errors) {
  FitOptions options;
  options.loss = loss;
  options.samples = 40;
  options.threads = 1;
  Coverage coverage;
  for (int seed = 0; seed < flights; ++seed) {
    const Record record = simulate_with_outliers(static_cast<std::uint64_t>(seed), both_ways);
    const Fit fit = sepcal::fit(sepcal::ScalarExample1{}, record, options);
    REQUIRE(fit.status == sepcal::FitStatus::converged);
    int inside = 0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const sepcal::Parameter& parameter = fit.parameters[k];
      const bool covers = std::abs(parameter.value - truth[k]) < errors * parameter.standard_error;
      coverage.within[k] += covers ? 1 : 0;
      inside += covers ? 1 : 0;
    }
    coverage.all_three += inside == 3 ? 1 : 0;
  }
  return coverage;
}

}  // namespace

TEST_CASE("outliers on both sides: 95 % intervals of robust fits cover") {
  for (const Loss loss : {Loss::huber, Loss::cauchy}) {
    CAPTURE(sepcal::to_string(loss));
    for (const int within : count(loss, true, 1.96).within) {
      CHECK(within >= 268);
      CHECK(within <= 298);
    }
  }
}

TEST_CASE(
    "outliers on one side: robust fits stay within three standard errors, the plain one not") {
  CHECK(count(Loss::huber, false, 3.0).all_three >= 290);
  CHECK(count(Loss::cauchy, false, 3.0).all_three >= 290);
  const FitOptions plain;
  int off = 0;
  for (int seed = 0; seed < flights; ++seed) {
    const Record record = simulate_with_outliers(static_cast<std::uint64_t>(seed), false);
    const Fit robust = sepcal::fit(sepcal::ScalarExample1{}, record, {.loss = Loss::cauchy});
    const Fit fit = sepcal::fit(sepcal::ScalarExample1{}, record, plain);
    off += std::abs(fit["c"].value - truth[1]) > 3.0 * robust["c"].standard_error ? 1 : 0;
    if (seed == 0) {
      CHECK(robust.method == sepcal::SecondStage::joint);
      CHECK(robust.noise[0].value < 0.13);
      CHECK(fit.noise[0].value > 0.5);
      CHECK(robust["c"].standard_error < 0.3 * fit["c"].standard_error);
    }
  }
  CHECK(off >= 290);
}

TEST_CASE("a wide loss is squares") {
  const auto flight = sepcal::test::simulate_five_hole(300);
  FitOptions options;
  options.samples = 50;
  options.second_stage = sepcal::SecondStage::joint;
  options.coloured_errors = false;
  const Fit plain = sepcal::fit(*flight.model, flight.record, options);
  for (const Loss loss : {Loss::huber, Loss::cauchy}) {
    options.loss = loss;
    options.loss_width = loss == Loss::huber ? 30.0 : 1e6;
    if (loss == Loss::cauchy) options.noise = {};
    const Fit wide = sepcal::fit(*flight.model, flight.record, options);
    for (const sepcal::Parameter& parameter : plain.parameters) {
      const sepcal::Parameter& other = wide[parameter.name];
      const double closeness = loss == Loss::huber ? 1e-7 : 0.2;  // cauchy's scale stays robust
      CHECK(std::abs(other.value - parameter.value) < closeness * parameter.standard_error);
      // The sandwich counts each residual by its own square.
      CHECK(other.standard_error == doctest::Approx(parameter.standard_error).epsilon(0.25));
    }
  }
}
