// SPDX-License-Identifier: BSD-3-Clause
// Defaults as documented, and each misuse of an option as one clear line.
#include "sepcal/options.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "simulated_records.hpp"

namespace options_test {

using doctest::Contains;
using sepcal::FitOptions;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

void fit_with(const FitOptions& options) {
  static const auto flight = sepcal::test::simulate_five_hole(40);
  (void)sepcal::fit(*flight.model, flight.record, options);
}

/// The fit throws an Error with these words once `change` has had its way with the defaults.
template <class Change>
void check_refused(const Change& change, const char* words) {
  FitOptions options;
  change(options);
  CHECK_THROWS_WITH_AS(fit_with(options), Contains(words), sepcal::Error);
}

}  // namespace

TEST_CASE("the defaults are those of the documentation") {
  const FitOptions options;
  CHECK(options.samples == 500);
  CHECK(options.sampling == sepcal::Sampling::uniform);
  CHECK(options.seed == 0);
  CHECK(options.second_stage == sepcal::SecondStage::automatic);
  CHECK(options.noise_tolerance < 0.05);  // much tighter than the paper's
  CHECK(options.bounds.empty());
  CHECK(options.start.empty());
  CHECK(options.search == sepcal::Search::sampling);
  CHECK(options.jacobian == sepcal::ProjectedJacobian::kaufman);
  CHECK(options.loss == sepcal::Loss::squares);
  CHECK(options.loss_width == 0.0);
  CHECK(options.prior.empty());
  CHECK_FALSE(options.screens.has_value());
}

TEST_CASE("an unknown name is refused with the names that there are") {
  check_refused([](FitOptions& o) { o.bounds = {{"w_x", {-1, 1}}}; },
                "no parameter 'w_x'; did you mean 'w_n'? The model has: lambda_va, b_va");
  check_refused([](FitOptions& o) { o.fix = {{"w_x", 0}}; },
                "no parameter 'w_x'; did you mean 'w_n'? The model has: lambda_va");
  check_refused([](FitOptions& o) { o.noise = {{"vx", 1}}; },
                "no output 'vx'; did you mean 'vn'? The model has: vn, ve, vd");
  check_refused([](FitOptions& o) { o.prior = {{"w_x", {}}}; },
                "no parameter 'w_x'; did you mean 'w_n'? The model has: lambda_va");
  check_refused([](FitOptions& o) { o.sampling_distribution = {{"w_x", {}}}; },
                "'w_x'; the model has: lambda_alpha");
  check_refused([](FitOptions& o) { o.sampling_distribution = {{"w_n", {}}}; },
                "nonlinear parameter (only these are sampled) 'w_n'");
  check_refused([](FitOptions& o) { o.start = {{"w_x", 0}}; },
                "'w_x'; the model has: lambda_alpha");
  check_refused([](FitOptions& o) { o.start = {{"w_n", 0}}; },
                "nonlinear parameter (only these have a start) 'w_n'");
  check_refused([](FitOptions& o) { o.stage_one_segments = "loop"; }, "'loop'");
  check_refused([](FitOptions& o) { o.stage_two_segments = "loop"; }, "'loop'");
}

TEST_CASE("bounds that leave no room are refused") {
  check_refused([](FitOptions& o) { o.bounds = {{"w_n", {1, 1}}}; },
                "bounds of 'w_n' leave no room");
  check_refused([](FitOptions& o) { o.bounds = {{"w_n", {2, 1}}}; },
                "bounds of 'w_n' leave no room");
  check_refused([](FitOptions& o) { o.bounds = {{"w_n", {not_a_number, 1}}}; },
                "bounds of 'w_n' leave no room");
}

TEST_CASE("a fixed value outside its bounds, or every parameter fixed, is refused") {
  check_refused([](FitOptions& o) { o.fix = {{"eps_phi", 0.3}}; },
                "fixed value of 'eps_phi' is outside its bounds");
  check_refused([](FitOptions& o) { o.fix = {{"eps_phi", not_a_number}}; },
                "fixed value of 'eps_phi'");
  const auto fix_all = [](FitOptions& o) {
    for (const auto& parameter : sepcal::tables_of<sepcal::FiveHoleProbe>().parameters()) {
      o.fix[parameter.name] = 0.0;
    }
  };
  check_refused(fix_all, "every parameter is fixed");
}

TEST_CASE("noise must be positive and given for every output or for none") {
  for (const double bad : {0.0, -1.0, not_a_number, sepcal::infinity}) {
    check_refused([bad](FitOptions& o) { o.noise = {{"vn", bad}, {"ve", 1}, {"vd", 1}}; },
                  "noise of output 'vn'");
  }
  check_refused([](FitOptions& o) { o.noise = {{"vn", 1}}; }, "not for output 've'");
}

TEST_CASE("counts and tolerances that make no sense are refused") {
  check_refused([](FitOptions& o) { o.loss_width = 2.0; }, "loss_width is given without a loss");
  check_refused([](FitOptions& o) { o.samples = -1; }, "samples");
  check_refused([](FitOptions& o) { o.descents = 0; }, "descents");
  check_refused([](FitOptions& o) { o.noise_tolerance = 0; }, "noise_tolerance");
  check_refused([](FitOptions& o) { o.noise_iterations = 0; }, "noise_iterations");
  check_refused([](FitOptions& o) { o.iterations = 0; }, "iterations");
}

TEST_CASE("a parameter without finite bounds can't be sampled without a distribution") {
  const auto drawn_from = [](double mean, double standard_deviation) {
    return [=](FitOptions& o) {
      o.bounds["b_alpha"] = {-sepcal::infinity, 1};
      o.sampling_distribution["b_alpha"] = {mean, standard_deviation};
    };
  };
  const auto unbounded = [](FitOptions& o) { o.bounds["b_alpha"] = {-sepcal::infinity, 1}; };
  check_refused(unbounded, "'b_alpha' has no finite bounds to draw samples from");
  check_refused(drawn_from(0, 0), "sampling distribution of 'b_alpha'");
  check_refused(drawn_from(100, 0.1),
                "sampling distribution of 'b_alpha' has no weight within its bounds");
  FitOptions options;
  drawn_from(0, 0.1)(options);
  CHECK_NOTHROW(fit_with(options));
}

TEST_CASE("a start that is not finite is refused, any other is a good start for the same fit") {
  for (const double bad : {not_a_number, sepcal::infinity}) {
    check_refused([bad](FitOptions& o) { o.start = {{"b_alpha", bad}}; },
                  "the start of 'b_alpha' is not a finite number");
  }
  const auto flight = sepcal::test::simulate_five_hole(200);
  FitOptions options;
  options.samples = 100;
  const auto sampled = sepcal::fit(*flight.model, flight.record, options);
  options.start = {{"eps_phi", -0.2}, {"lambda_alpha", 0.4}};
  const auto started = sepcal::fit(*flight.model, flight.record, options);
  CHECK(started.status == sepcal::FitStatus::converged);
  CHECK((started.xi2() - sampled.xi2()).cwiseAbs().maxCoeff() < 1e-7);
  CHECK((started.xi1() - sampled.xi1()).cwiseAbs().maxCoeff() < 1e-6);
}

TEST_CASE("only a nonlinear parameter can be left out of the sampling") {
  check_refused([](FitOptions& o) { o.unsampled = {{"w_n", 0.0}}; },
                "no nonlinear parameter (only these are sampled) 'w_n'");
  check_refused([](FitOptions& o) { o.unsampled = {{"b_gamma", 0.0}}; }, "'b_gamma'");
}

TEST_CASE("fewer measurements than parameters is misuse, just as many is not") {
  const auto fit_rows = [](std::size_t rows) {
    const auto wave = sepcal::test::simulate_scalar_1(rows);
    return sepcal::fit(*wave.model, wave.record);
  };
  CHECK_THROWS_WITH_AS(fit_rows(2), Contains("fewer measurements than the 3 parameters"),
                       sepcal::Error);
  const auto exact = fit_rows(3);  // no freedom left to estimate R from
  CHECK(std::isnan(exact["a"].standard_error));
  CHECK(std::isfinite(exact.cost));
}

}  // namespace options_test
