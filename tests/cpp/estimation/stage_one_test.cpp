// SPDX-License-Identifier: BSD-3-Clause
// Stage one: Tr[R] of every sample, the minima, the verdict (Steps 2-4).
#include "sepcal/detail/stage_one.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "dense_reference.hpp"
#include "numerics/decompositions.hpp"
#include "profile_cost.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "simulated_records.hpp"
#include "small_models.hpp"

namespace stage_one_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::FitOptions;
using sepcal::stage_one;
using sepcal::StageOne;
using sepcal::test::dense_trace;
using sepcal::test::Simulated;

namespace {

FitOptions samples(int count) {
  FitOptions options;
  options.samples = count;
  return options;
}

}  // namespace

TEST_CASE("Tr[R] of every sample is that of a dense linear least squares at it") {
  for (const Simulated& simulated : sepcal::test::simulate_all(300)) {
    CAPTURE(simulated.name);
    const StageOne result = stage_one(*simulated.model, simulated.record, samples(40));
    REQUIRE(result.samples.rows() == simulated.xi2.size());
    REQUIRE(result.trace_r.size() == 40);
    for (Index s = 0; s < 40; ++s) {
      const double expected = dense_trace(simulated, result.samples.col(s));
      CHECK(result.trace_r[s] == Approx(expected).epsilon(1e-10));
    }
    Index best = 0;
    CHECK(result.best_trace_r == result.trace_r.minCoeff(&best));
    CHECK(result.best == result.samples.col(best));
  }
}

TEST_CASE("a clear record has a unique minimum, which stage two starts from") {
  for (const Simulated& simulated : sepcal::test::simulate_all(400)) {
    CAPTURE(simulated.name);
    const StageOne result = stage_one(*simulated.model, simulated.record, samples(300));
    CHECK(result.unique_minimum);
    CHECK(result.flat_directions.empty());
    REQUIRE(result.minima.size() == 1);
    CHECK(result.minima[0].trace_r <= result.best_trace_r * (1 + 1e-12));
    CHECK(result.minima[0].trace_r == Approx(dense_trace(simulated, result.xi2)).epsilon(1e-10));
    CHECK(result.xi2 == result.minima[0].xi2);
    CHECK((result.xi2 - simulated.xi2).cwiseAbs().maxCoeff() < 0.15);
    CHECK(result.noise.squaredNorm() == Approx(result.minima[0].trace_r).epsilon(1e-9));
    const MatrixXd rows =
        sepcal::test::dense_rows(*simulated.model, simulated.record, result.xi1, result.xi2);
    const MatrixXd A = rows.leftCols(result.xi1.size());
    CHECK((A.transpose() * rows.rightCols<1>()).norm() < 1e-9 * A.norm());
  }
}

TEST_CASE("any number of threads gives the same stage one bit for bit, another seed another") {
  const Simulated flight = sepcal::test::simulate_five_hole(5'000);
  FitOptions options = samples(60);
  options.threads = 1;
  const StageOne one = stage_one(*flight.model, flight.record, options);
  for (const int threads : {2, 3}) {
    options.threads = threads;
    const StageOne several = stage_one(*flight.model, flight.record, options);
    CHECK(several.samples == one.samples);
    CHECK(several.trace_r == one.trace_r);
    CHECK(several.xi1 == one.xi1);
    CHECK(several.xi2 == one.xi2);
    CHECK(several.noise == one.noise);
  }
  options.seed = 1;
  CHECK(stage_one(*flight.model, flight.record, options).samples != one.samples);
}

TEST_CASE("over a whole turn the phase of a cosine has two minima, half a turn apart") {
  // (1 + a) cos(eta + b): b + pi with -(1 + a) is the same wave. The maxima are at 0 and +-pi.
  Simulated wave = sepcal::test::simulate_scalar_1(200);
  sepcal::Record record;
  const auto eta = wave.record.column("eta");
  record.view("eta", eta);
  sepcal::test::Draws draws(71);
  sepcal::test::add_outputs(record, *wave.model, wave.xi1,
                            VectorXd::Constant(1, 0.5 * std::numbers::pi),
                            VectorXd::Constant(1, 0.1), draws);
  FitOptions options = samples(200);
  options.bounds["b"] = {-std::numbers::pi, std::numbers::pi};
  const StageOne result = stage_one(*wave.model, record, options);
  CHECK_FALSE(result.unique_minimum);
  REQUIRE(result.minima.size() >= 2);
  CHECK(std::abs(result.minima[0].xi2[0] - result.minima[1].xi2[0]) ==
        Approx(std::numbers::pi).epsilon(1e-6));
  CHECK(result.minima[0].trace_r == Approx(result.minima[1].trace_r).epsilon(1e-9));
  for (std::size_t i = 2; i < result.minima.size(); ++i) {  // the noise may tip the box's edges
    CHECK(result.minima[i].trace_r > 5 * result.minima[0].trace_r);
  }
}

TEST_CASE("a direction along which Tr[R] is flat is named, and there is no unique minimum") {
  // With no flow angle measured, lambda_alpha and lambda_beta multiply zeros.
  const Simulated flight = sepcal::test::simulate_five_hole(200);
  sepcal::Record record;
  const std::vector<double> zeros(200, 0.0);
  for (const auto& input : flight.model->tables().inputs) {
    if (!flight.record.has(input.name)) continue;
    record.view(input.name, input.name == "dpa" ? std::span<const double>(zeros)
                                                : flight.record.column(input.name));
  }
  sepcal::test::Draws draws(72);
  sepcal::test::add_outputs(record, *flight.model, flight.xi1, flight.xi2,
                            Eigen::Vector3d(0.1, 0.1, 0.1), draws);
  const StageOne result = stage_one(*flight.model, record, samples(100));
  CHECK_FALSE(result.unique_minimum);
  REQUIRE(result.flat_directions.size() == 1);
  CHECK(result.flat_directions[0] == "lambda_alpha");
}

TEST_CASE("nothing nonlinear needs no samples: one minimum, the linear estimate") {
  sepcal::Record record;
  record.add("u", {0, 1, 2, 3}).add("z", {1.1, 2.9, 5.1, 6.9});
  const auto model = sepcal::block_model(sepcal::test::Line{});
  const StageOne result = stage_one(*model, record);
  CHECK(result.unique_minimum);
  CHECK(result.xi2.size() == 0);
  CHECK(result.xi1[0] == Approx(1.96));  // by hand: Sxy / Sxx = 9.8 / 5
  CHECK(result.xi1[1] == Approx(1.06));
  CHECK(result.noise[0] * result.noise[0] * 4 == Approx(0.032));
}

TEST_CASE("without samples stage two starts from the middle of the bounds, and nothing is known") {
  const Simulated wave = sepcal::test::simulate_scalar_2(100);
  FitOptions options = samples(0);
  options.bounds["c"] = {-0.2, 1.0};
  const StageOne result = stage_one(*wave.model, wave.record, options);
  CHECK(result.xi2 == Eigen::Vector2d(0.0, 0.4));
  CHECK(result.samples.size() == 0);
  CHECK_FALSE(result.unique_minimum);
}

TEST_CASE("with a start stage one samples nothing and stage two begins there, within the bounds") {
  const Simulated wave = sepcal::test::simulate_scalar_2(100);
  FitOptions options = samples(50);
  options.start = {{"c", -0.3}};
  const StageOne result = stage_one(*wave.model, wave.record, options);
  CHECK(result.xi2 == Eigen::Vector2d(0.0, -0.3));  // b: the middle of its bounds
  CHECK(result.samples.size() == 0);
  CHECK_FALSE(result.unique_minimum);
  options.start = {{"b", 7.0}, {"c", -7.0}};
  CHECK(stage_one(*wave.model, wave.record, options).xi2 == Eigen::Vector2d(0.5, -1.0));
}

TEST_CASE("what is not sampled is held at its value, and the rest is as if it were fixed there") {
  const Simulated wave = sepcal::test::simulate_scalar_2(100);
  FitOptions fixed = samples(60);
  fixed.fix = {{"c", 0.3}};
  const StageOne expected = stage_one(*wave.model, wave.record, fixed);
  FitOptions options = samples(60);
  options.unsampled = {{"c", 0.3}};
  const StageOne result = stage_one(*wave.model, wave.record, options);
  CHECK(result.samples.row(0) == expected.samples.row(0));
  CHECK(result.samples.row(1) == MatrixXd::Constant(1, 60, 0.3));
  CHECK(result.trace_r == expected.trace_r);
  CHECK(result.xi2 == Eigen::Vector2d(expected.xi2[0], 0.3));
  CHECK(result.best == Eigen::Vector2d(expected.best[0], 0.3));
  REQUIRE(result.minima.size() == expected.minima.size());
  CHECK(result.minima[0].xi2 == Eigen::Vector2d(expected.minima[0].xi2[0], 0.3));
  CHECK(result.unique_minimum == expected.unique_minimum);
  CHECK(result.xi1 == expected.xi1);
  CHECK(result.noise == expected.noise);

  options.unsampled = {{"c", 7.0}};  // beyond the bounds: at them
  CHECK(stage_one(*wave.model, wave.record, options).xi2[1] == 1.0);
  options.unsampled = {{"b", 0.1}, {"c", 0.3}};
  CHECK(stage_one(*wave.model, wave.record, options).xi2 == Eigen::Vector2d(0.1, 0.3));
}

TEST_CASE("stage two frees what was not sampled") {
  const Simulated wave = sepcal::test::simulate_scalar_2(200);
  FitOptions options = samples(100);
  const sepcal::Fit sampled = sepcal::fit(*wave.model, wave.record, options);
  options.unsampled = {{"c", 0.0}};
  const sepcal::Fit unsampled = sepcal::fit(*wave.model, wave.record, options);
  CHECK(unsampled.stage_one.xi2[1] == 0.0);
  CHECK((unsampled.xi2() - sampled.xi2()).cwiseAbs().maxCoeff() < 1e-8);
}

TEST_CASE("a single sample is enough, and a distribution alone will do instead of bounds") {
  const Simulated wave = sepcal::test::simulate_scalar_1(100);
  CHECK(stage_one(*wave.model, wave.record, samples(1)).minima.size() == 1);
  FitOptions options = samples(50);
  options.bounds["b"] = {-sepcal::infinity, sepcal::infinity};
  options.sampling_distribution["b"] = {0.1, 0.3};
  const StageOne result = stage_one(*wave.model, wave.record, options);
  CHECK(result.xi2[0] == Approx(0.2).epsilon(0.3));
}

TEST_CASE("only the chosen segments are used") {
  Simulated wave = sepcal::test::simulate_scalar_1(300);
  wave.record.cut({{"calm", 0, 100}, {"loop", 100, 300}});
  FitOptions options = samples(30);
  options.stage_one_segments = "calm";
  const StageOne some = stage_one(*wave.model, wave.record, options);
  wave.record.cut({{"calm", 0, 100}});
  const StageOne all = stage_one(*wave.model, wave.record, samples(30));
  CHECK(some.trace_r == all.trace_r);
}

TEST_CASE("progress is told one call at a time, rising to one") {
  const Simulated wave = sepcal::test::simulate_scalar_1(2'000);
  FitOptions options = samples(200);
  options.threads = 3;
  double last = 0;
  options.progress = [&](std::string_view task, double fraction) {
    CHECK(task == "stage one");
    CHECK(fraction >= last);
    last = fraction;
  };
  (void)stage_one(*wave.model, wave.record, options);
  CHECK(last == 1.0);
}

TEST_CASE("a model that is finite nowhere is an error, one that is not everywhere is not") {
  sepcal::Record record;
  record.add("u", {1, 800, 2}).add("z", {1.2, 1e9, 1.5});
  FitOptions options = samples(50);
  const auto growth = sepcal::block_model(sepcal::test::Growth{});
  options.bounds["c"] = {-1, 1};  // exp(800 c) overflows for c > 0.89
  const StageOne result = stage_one(*growth, record, options);
  CHECK(std::isinf(result.trace_r.maxCoeff()));
  CHECK(std::isfinite(result.best_trace_r));
  options.bounds["c"] = {1, 2};
  CHECK_THROWS_WITH_AS(stage_one(*growth, record, options),
                       doctest::Contains("not finite at any of the 50"), sepcal::Error);
}

}  // namespace stage_one_test
