// SPDX-License-Identifier: BSD-3-Clause
// Stage one by NLopt: every minimum of problems that have several, against dense grids, each with
// a gradient of zero by differences; the same best minimum as by sampling.
#include "estimation/global_search.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <thread>

#include "profile_cost.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/models/pitot_static.hpp"
#include "small_models.hpp"

namespace global_search_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::Vector2d;
using Eigen::VectorXd;
using sepcal::FitOptions;
using sepcal::Search;
using sepcal::stage_one;
using sepcal::StageOne;
using sepcal::test::dense_gradient;
using sepcal::test::dense_trace;
using sepcal::test::global;
using sepcal::test::Simulated;

namespace {

/// Scalar example 2 over five turns of eta, where frequency and phase trade: c may be anything.
Simulated simulate_wave(std::uint64_t seed) {
  Simulated wave{"wave",
                 sepcal::block_model(sepcal::ScalarExample2{}),
                 Vector2d(0.5, -0.3),
                 Vector2d(0.15, -0.25),
                 {}};
  sepcal::test::Draws draws(seed);
  wave.record.add("eta", draws.uniform_column(200, 0, 10 * std::numbers::pi));
  add_outputs(wave.record, *wave.model, wave.xi1, wave.xi2, VectorXd::Constant(1, 0.3), draws);
  return wave;
}

/// A Pitot-static tube on three headings of a left turn.
Simulated simulate_headings(std::uint64_t seed) {
  Simulated tube{"tube",
                 sepcal::block_model(sepcal::PitotStatic{}),
                 Vector2d(0.95, 0.5),
                 Eigen::Vector3d(3, -2, 0),
                 {}};
  sepcal::test::Draws draws(seed);
  std::vector<double> north;
  std::vector<double> east;
  for (int k = 0; k < 120; ++k) {
    const double heading = 0.9 * (k / 40) + 0.02 * draws.normal();
    const double airspeed = draws.uniform(15, 30);
    north.push_back(airspeed * std::cos(heading) + 3);
    east.push_back(airspeed * std::sin(heading) - 2);
  }
  tube.record.add("vn", north).add("ve", east).add("vd", draws.uniform_column(120, -1, 1));
  add_outputs(tube.record, *tube.model, tube.xi1, tube.xi2, VectorXd::Constant(1, 0.3), draws);
  return tube;
}

FitOptions any_phase(FitOptions options) {
  options.bounds["c"] = {-std::numbers::pi, std::numbers::pi};
  return options;
}

/// Frequencies of the tone where Tr[R] is lower than on both sides, on a grid of 1e-3 rad/s.
std::vector<double> dips_on_a_grid(const Simulated& tone, double at_least_deep) {
  std::vector<double> trace;
  constexpr double step = 1e-3;
  for (int i = 0; i <= 2500; ++i) {
    trace.push_back(dense_trace(tone, VectorXd::Constant(1, 0.5 + step * i)));
  }
  std::vector<double> dips;
  for (std::size_t i = 1; i + 1 < trace.size(); ++i) {
    if (trace[i] > trace[i - 1] || trace[i] > trace[i + 1]) continue;
    std::size_t left = i;
    std::size_t right = i;
    while (left > 0 && trace[left - 1] >= trace[left]) --left;
    while (right + 1 < trace.size() && trace[right + 1] >= trace[right]) ++right;
    if (std::min(trace[left], trace[right]) - trace[i] > at_least_deep) {
      dips.push_back(0.5 + step * static_cast<double>(i));
    }
  }
  return dips;
}

/// Zero within what rounding leaves where inside, pointing out of the box on a bound.
void check_stationary(const Simulated& problem, const VectorXd& xi2,
                      const std::vector<std::pair<double, double>>& bounds) {
  const VectorXd gradient = dense_gradient(problem, xi2);
  const double scale = dense_trace(problem, xi2);
  for (Index k = 0; k < xi2.size(); ++k) {
    const auto [lower, upper] = bounds[static_cast<std::size_t>(k)];
    CAPTURE(xi2.transpose());
    CAPTURE(k);
    if (xi2[k] <= lower) {
      CHECK(gradient[k] > 0);
    } else if (xi2[k] >= upper) {
      CHECK(gradient[k] < 0);
    } else {
      CHECK(std::abs(gradient[k]) * 0.5 * (upper - lower) < 2e-5 * scale);
    }
  }
}

}  // namespace

TEST_CASE("every side lobe of a tone is found, those of a dense grid and no others") {
  for (const std::uint64_t seed : {5U, 6U, 7U}) {
    CAPTURE(seed);
    const Simulated tone = sepcal::test::simulate_tone(seed);
    FitOptions options = global();
    options.descents = 30;
    const StageOne result = stage_one(*tone.model, tone.record, options);
    CHECK_FALSE(result.unique_minimum);
    // Ripples that the record can't tell from none are no minima: a rise of s^2 in S, s^2 / 300 of
    // Tr[R].
    const double clear = 2.0 * 0.7 / 300;
    const std::vector<double> dips = dips_on_a_grid(tone, clear);
    const std::vector<double> ripples = dips_on_a_grid(tone, 0.0);
    CHECK(dips.size() >= 6);
    for (const double dip : dips) {
      CAPTURE(dip);
      CHECK(std::ranges::any_of(result.minima, [&](const auto& minimum) {
        return std::abs(minimum.xi2[0] - dip) < 2e-3;
      }));
    }
    for (const auto& minimum : result.minima) {
      CAPTURE(minimum.xi2[0]);
      CHECK(minimum.trace_r == Approx(dense_trace(tone, minimum.xi2)).epsilon(1e-10));
      check_stationary(tone, minimum.xi2, {{0.5, 3.0}});
      const bool at_a_bound = minimum.xi2[0] <= 0.5 || minimum.xi2[0] >= 3.0;
      CHECK((at_a_bound || std::ranges::any_of(ripples, [&](double ripple) {
               return std::abs(minimum.xi2[0] - ripple) < 2e-3;
             })));
    }
    CHECK(result.minima[0].xi2[0] == Approx(1.7).epsilon(0.02));
  }
}

TEST_CASE("the two phases of a wave half a turn apart are both found, and all are stationary") {
  const Simulated wave = simulate_wave(6);
  const StageOne result = stage_one(*wave.model, wave.record, any_phase(global()));
  double lowest_on_a_grid = sepcal::infinity;
  for (int i = 0; i <= 200; ++i) {
    for (int k = 0; k <= 200; ++k) {
      const Vector2d xi2(-0.5 + 0.005 * i, std::numbers::pi * (-1.0 + 0.01 * k));
      lowest_on_a_grid = std::min(lowest_on_a_grid, dense_trace(wave, xi2));
    }
  }
  REQUIRE(result.minima.size() >= 2);
  CHECK(result.minima[0].trace_r <= lowest_on_a_grid);
  CHECK(result.minima[0].trace_r > 0.95 * lowest_on_a_grid);
  CHECK(result.minima[1].trace_r == Approx(result.minima[0].trace_r).epsilon(1e-9));
  const VectorXd apart = result.minima[0].xi2 - result.minima[1].xi2;
  CHECK(std::abs(apart[0]) < 1e-6);
  CHECK(std::abs(apart[1]) == Approx(std::numbers::pi).epsilon(1e-6));
  for (const auto& minimum : result.minima) {
    check_stationary(wave, minimum.xi2, {{-0.5, 0.5}, {-std::numbers::pi, std::numbers::pi}});
  }
}

TEST_CASE("a tube on three headings has a second minimum, on a bound of the wind") {
  const Simulated tube = simulate_headings(7);
  FitOptions options = global();
  options.fix["w_d"] = 0.0;
  const StageOne result = stage_one(*tube.model, tube.record, options);
  REQUIRE(result.minima.size() >= 2);
  CHECK(result.minima[0].xi2[0] == Approx(3).epsilon(0.1));
  CHECK(result.minima[0].xi2[1] == Approx(-2).epsilon(0.2));
  int on_a_bound = 0;
  for (const auto& minimum : result.minima) {
    const VectorXd gradient =
        dense_gradient(tube, Eigen::Vector3d(minimum.xi2[0], minimum.xi2[1], 0)).head(2);
    bool touches = false;
    for (Index k = 0; k < 2; ++k) {
      CAPTURE(minimum.xi2.transpose());
      const double x = minimum.xi2[k];
      const double slope = gradient[k] * 100 / minimum.trace_r;  // over half the width
      REQUIRE(std::abs(x) <= 100);
      if (std::abs(x) < 100) {
        CHECK(std::abs(slope) < 1e-4);
      } else {
        touches = true;
        CHECK(slope * x < 0);           // lower beyond the bound
        CHECK(std::abs(slope) > 1e-3);  // more than differences leave
      }
    }
    on_a_bound += touches ? 1 : 0;
  }
  CHECK(on_a_bound >= 1);
  CHECK(std::abs(result.minima[0].xi2[0]) < 100);
}

TEST_CASE("sampling and the global search agree on the best minimum") {
  std::vector<std::pair<Simulated, FitOptions>> problems;
  for (Simulated& simulated : sepcal::test::simulate_all(300)) {
    problems.emplace_back(std::move(simulated), FitOptions{});
  }
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    problems.emplace_back(sepcal::test::simulate_tone(seed), FitOptions{});
    problems.emplace_back(simulate_wave(seed), any_phase({}));
    problems.emplace_back(simulate_headings(seed), FitOptions{});
    problems.back().second.fix["w_d"] = 0.0;
  }
  for (auto& [problem, options] : problems) {
    CAPTURE(problem.name);
    options.search = Search::global;
    const StageOne searched = stage_one(*problem.model, problem.record, options);
    options.search = Search::sampling;
    for (options.seed = 0; options.seed < 3; ++options.seed) {
      const StageOne sampled = stage_one(*problem.model, problem.record, options);
      CHECK(searched.minima[0].trace_r == Approx(sampled.minima[0].trace_r).epsilon(1e-9));
      const bool twins = problem.name == "wave";  // two phases are equally good
      if (!twins) CHECK((searched.xi2 - sampled.xi2).norm() < 1e-5 * (1 + sampled.xi2.norm()));
    }
  }
}

TEST_CASE("the points asked for stand in the result, as many as were allowed") {
  const Simulated wave = sepcal::test::simulate_scalar_2(100);
  for (const int evaluations : {1, 2, 60}) {
    const StageOne result = stage_one(*wave.model, wave.record, global(evaluations));
    REQUIRE(result.samples.cols() == evaluations);
    for (Index s = 0; s < evaluations; ++s) {
      CHECK(result.trace_r[s] == Approx(dense_trace(wave, result.samples.col(s))).epsilon(1e-10));
    }
    CHECK(result.best_trace_r == result.trace_r.minCoeff());
    CHECK(result.minima.size() >= 1);
  }
  CHECK(stage_one(*wave.model, wave.record, global(1)).samples == Vector2d(0, 0));
}

TEST_CASE("no seed, no number of threads and no other search changes a bit") {
  const Simulated flight = sepcal::test::simulate_five_hole(5'000);
  FitOptions options = global(60);
  options.threads = 1;
  const StageOne one = stage_one(*flight.model, flight.record, options);
  options.seed = 9;
  StageOne other;
  std::thread beside([&] { other = stage_one(*flight.model, flight.record, options); });
  options.threads = 3;
  const StageOne several = stage_one(*flight.model, flight.record, options);
  beside.join();
  for (const StageOne* again : std::array<const StageOne*, 2>{&other, &several}) {
    CHECK(again->samples == one.samples);
    CHECK(again->trace_r == one.trace_r);
    CHECK(again->xi2 == one.xi2);
    CHECK(again->xi1 == one.xi1);
  }
}

TEST_CASE("progress rises to one") {
  const Simulated wave = sepcal::test::simulate_scalar_1(100);
  FitOptions options = global(50);
  double last = 0;
  options.progress = [&](std::string_view task, double fraction) {
    CHECK(task == "stage one");
    CHECK(fraction > last);
    last = fraction;
  };
  (void)stage_one(*wave.model, wave.record, options);
  CHECK(last == 1.0);
}

}  // namespace global_search_test
