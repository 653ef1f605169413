// SPDX-License-Identifier: BSD-3-Clause
// Block errors against real refits with each block left out, and against closed forms.
#include "estimation/block_errors.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "noises.hpp"
#include "sepcal/fit.hpp"
#include "small_models.hpp"

namespace block_errors_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::Record;
using sepcal::Segment;
using sepcal::estimation::choose_blocks;
using sepcal::estimation::cut_blocks;
using sepcal::estimation::find_block_errors;
using sepcal::estimation::Memory;
using sepcal::test::draw_autoregression;
using sepcal::test::draw_noise;
using sepcal::test::Draws;
using sepcal::test::Growth;
using sepcal::test::Line;

namespace {

double find_memory(const VectorXd& residual) {
  Memory memory(1);
  memory.add(residual);
  return memory.rows();
}

std::vector<double> column(const VectorXd& values) { return {values.begin(), values.end()}; }

/// The jackknife's covariance by refits: B are the blocks that the fit will have cut, as its
/// residual and R tell.
template <class Model>
MatrixXd refit_without_blocks(const Model& model, Record record, const Fit& fit,
                              const VectorXd& residual, FitOptions options) {
  const auto rows = residual.size();
  const int blocks = choose_blocks(rows, find_memory(residual));
  REQUIRE(blocks >= 8);
  const std::vector<Index> first = cut_blocks(rows, blocks);
  for (const sepcal::Parameter& parameter : fit.parameters) {
    if (parameter.fixed) options.fix[parameter.name] = parameter.value;
  }
  options.start = fit.nonlinear_estimates();
  for (const sepcal::OutputValue& noise : fit.noise) options.noise[noise.name] = noise.value;
  const Index n = fit.values().size();
  MatrixXd sum = MatrixXd::Zero(n, n);
  for (std::size_t b = 0; b + 1 < first.size(); ++b) {
    const auto from = static_cast<std::size_t>(first[b]);
    const auto to = static_cast<std::size_t>(first[b + 1]);
    std::vector<Segment> kept;
    if (from > 0) kept.push_back({"", 0, from});
    if (to < record.length()) kept.push_back({"", to, record.length()});
    record.cut(kept);
    const VectorXd moved = sepcal::fit(model, record, options).values() - fit.values();
    sum += moved * moved.transpose();
  }
  return (blocks - 1.0) / blocks * sum;
}

}  // namespace

TEST_CASE("of a linear model a step is a refit, to the last digits; with a prior as well") {
  constexpr Index rows = 600;
  for (const bool known : {false, true}) {
    CAPTURE(known);
    Draws draws(11);
    const VectorXd u = VectorXd::LinSpaced(rows, 0.0, 6.0);
    const VectorXd z = 2.0 * u + draw_noise("AR(0.9)", rows, draws);
    Record record;
    record.add("u", column(u)).add("z", column(z));
    FitOptions options;
    options.noise = {{"z", 2.0}};
    if (known) options.prior = {{"s", {2.1, 0.3}}};
    const Fit fit = sepcal::fit(Line{}, record, options);
    const VectorXd r = z - fit["s"].value * u - VectorXd::Constant(rows, fit["c"].value);
    MatrixXd expected = refit_without_blocks(Line{}, record, fit, r, options);
    if (known) {  // what a prior pulls is as uncertain as the prior
      const VectorXd pulled = fit.covariance_white.col(0) / 0.3;
      expected += pulled * pulled.transpose();
    }
    CHECK((fit.covariance_blocks - expected).norm() < 1e-8 * expected.norm());
    CHECK(fit["s"].standard_error_blocks == Approx(std::sqrt(expected(0, 0))));
  }
}

TEST_CASE("of a bent model a step is a refit to some per cent, with a robust loss too") {
  constexpr Index rows = 900;
  for (const sepcal::Loss loss : {sepcal::Loss::squares, sepcal::Loss::huber}) {
    CAPTURE(static_cast<int>(loss));
    Draws draws(12);
    const VectorXd u = VectorXd::LinSpaced(rows, 0.0, 1.0);
    const VectorXd z = (0.7 * u).array().exp().matrix() + 0.05 * draw_noise("bursty", rows, draws);
    Record record;
    record.add("u", column(u)).add("z", column(z));
    FitOptions options;
    options.bounds = {{"c", {-3.0, 3.0}}};
    options.loss = loss;
    const Fit fit = sepcal::fit(Growth{}, record, options);
    const VectorXd r = z - (fit.parameters[0].value * u).array().exp().matrix();
    const MatrixXd expected = refit_without_blocks(Growth{}, record, fit, r, options);
    CHECK(fit.parameters[0].standard_error_blocks ==
          Approx(std::sqrt(expected(0, 0))).epsilon(loss == sepcal::Loss::squares ? 0.01 : 0.06));
  }
}

TEST_CASE("the memory of a residual is the textbook's for AR(1), and 1 for white noise") {
  Draws draws(13);
  const double white = find_memory(draw_noise("white", 40'000, draws));
  const double slow = find_memory(draw_autoregression(0.9, 40'000, draws));
  CHECK(white < 2.0);        // the largest of several estimates of 1
  CHECK(slow > 0.7 * 19.0);  // (1 + 0.9) / (1 - 0.9)
  CHECK(slow < 1.9 * 19.0);
  CHECK(find_memory(VectorXd::Zero(100)) == 1.0);
  CHECK(std::isnan(find_memory(VectorXd::Constant(40, std::numeric_limits<double>::infinity()))));
}

TEST_CASE("blocks share the rows out, and are as many as the noise allows") {
  CHECK(choose_blocks(4000, 1.0) == 40);
  CHECK(choose_blocks(4000, 50.0) == 26);
  CHECK(choose_blocks(4000, 1000.0) == 8);
  CHECK(choose_blocks(15, 1.0) == 0);
  const std::vector<Index> first = cut_blocks(103, 8);
  CHECK(first.front() == 0);
  CHECK(first.back() == 103);
  for (std::size_t b = 0; b + 1 < first.size(); ++b) {
    CHECK(first[b + 1] - first[b] >= 12);
    CHECK(first[b + 1] - first[b] <= 13);
  }
}

TEST_CASE("what one block alone determines has no block error, the others keep theirs") {
  constexpr Index rows = 400;
  Draws draws(14);
  VectorXd u = VectorXd::Zero(rows);  // 0 but for a stretch within a block
  for (Index t = 100; t < 108; ++t) u[t] = 1.0 + 0.1 * static_cast<double>(t - 100);
  Record record;
  record.add("u", column(u)).add("z", column(u + draw_noise("white", rows, draws)));
  const Fit fit = sepcal::fit(Line{}, record);
  CHECK(std::isnan(fit["s"].standard_error_blocks));
  CHECK(std::isfinite(fit["s"].standard_error));
  CHECK(fit["c"].standard_error_blocks == Approx(fit["c"].standard_error).epsilon(0.5));
}

TEST_CASE("blocks are believed where gaps hide slow noise from the noise model, and it is said") {
  // Levels of 120 rows each, in runs of 12 that a noise model takes for independent.
  constexpr Index rows = 1200;
  Draws draws(15);
  const VectorXd levels = draw_noise("white", rows / 120, draws);
  VectorXd z = 0.3 * draw_noise("white", rows, draws);
  std::vector<double> time;
  for (Index t = 0; t < rows; ++t) {
    z[t] += levels[t / 120];
    time.push_back(static_cast<double>(t) + 1000.0 * static_cast<double>(t / 12));
  }
  Record record;
  record.add("u", column(VectorXd::LinSpaced(rows, -1.0, 1.0))).add("z", column(z));
  record.add("time", time).cut(sepcal::find_segments(time, {}));
  REQUIRE(record.segments().size() == 100);
  const Fit fit = sepcal::fit(Line{}, record);
  const sepcal::Parameter& level = fit["c"];
  CHECK(level.standard_error_blocks > 2.0 * level.standard_error_noise_model);
  CHECK(level.standard_error == Approx(level.standard_error_blocks));
  CHECK(level.standard_error == Approx(std::sqrt(fit.covariance(1, 1))));
  CHECK(fit.message.find("is by blocks of the record") != std::string::npos);
  CHECK(fit.message.find("gaps cut the record into 100 pieces of about 12 rows") !=
        std::string::npos);
}

TEST_CASE("in white noise block errors are those of white noise, on average to some per cent") {
  // 200 records of 20 blocks: the mean of the variances is uncertain by sqrt(2 / 19 / 200) = 2.3 %.
  constexpr Index rows = 200;
  double sum = 0.0;
  for (int seed = 0; seed < 200; ++seed) {
    Draws draws(static_cast<std::uint64_t>(seed));
    const VectorXd e = draw_noise("white", rows, draws);
    MatrixXd rows_of_mean(rows, 2);
    rows_of_mean << VectorXd::Ones(rows), VectorXd(e.array() - e.mean());
    const MatrixXd R = MatrixXd::Constant(1, 1, std::sqrt(static_cast<double>(rows)));
    std::vector<sepcal::TriangularFactor> blocks;
    for (Index first = 0; first < rows; first += rows / 20) {
      MatrixXd block = rows_of_mean.middleRows(first, rows / 20);
      blocks.emplace_back(2).absorb(block);
    }
    const auto errors = find_block_errors(blocks, R);
    CHECK(errors.freedom[0] == Approx(19.0).epsilon(1e-9));
    sum += errors.covariance(0, 0) * rows / 200;
  }
  CHECK(sum == Approx(20.0 / 19.0).epsilon(0.08));
}

}  // namespace block_errors_test
