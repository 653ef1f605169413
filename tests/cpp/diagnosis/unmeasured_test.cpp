// SPDX-License-Identifier: BSD-3-Clause
// Common causes and lines in whitened residuals: their rates, and what is told of them.
#include "diagnosis/unmeasured.hpp"

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>
#include "diagnosis/common_cause.hpp"
#include "diagnosis/spectral_line.hpp"
#include "noises.hpp"

namespace unmeasured_test {

using namespace sepcal;
using namespace sepcal::test;
using namespace sepcal::diagnosis;
using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr Index rows = 400;

MatrixXd draw_outputs(const std::string& kind, Index outputs, Draws& draws) {
  MatrixXd white(rows, outputs);
  for (Index j = 0; j < outputs; ++j) white.col(j) = draw_noise(kind, rows, draws);
  return white;
}

std::vector<double> even_times(double interval) {
  std::vector<double> time(rows);
  for (std::size_t i = 0; i < time.size(); ++i) time[i] = interval * static_cast<double>(i);
  return time;
}

/// A swing of rows [first, last), of unit amplitude.
VectorXd swing(double cycles_a_row, Index first, Index last) {
  VectorXd wave = VectorXd::Zero(rows);
  for (Index i = first; i < last; ++i) {
    wave[i] = std::sin(2.0 * std::numbers::pi * cycles_a_row * static_cast<double>(i) + 0.4);
  }
  return wave;
}

}  // namespace

TEST_CASE("independent outputs have a common cause as often as the probability says") {
  constexpr int trials = 200;
  for (const std::string kind : {"white", "bursty"}) {
    CAPTURE(kind);
    Draws draws(11);
    int below = 0;
    for (int i = 0; i < trials; ++i) {
      const MatrixXd white = draw_outputs(kind, 3, draws);
      below += find_common_cause(white, static_cast<std::uint64_t>(i)).p_value <= 0.1 ? 1 : 0;
    }
    CHECK(!outside_binomial(below, trials, 0.1));
  }
}

TEST_CASE("a burst that two of three outputs share is told with its outputs and its time") {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Draws draws(seed);
    MatrixXd white = draw_outputs("white", 3, draws);
    const VectorXd burst = swing(0.11, 150, 210);
    const double size = 20.0 / (std::numbers::sqrt2 * burst.norm());  // 20 sigmas in all
    white.col(0) += size * burst;
    white.col(2) -= size * burst;
    const CommonCause cause = find_common_cause(white, seed);
    if (!(cause.p_value < 0.0034)) continue;
    ++found;
    CHECK(cause.outputs == std::vector<std::size_t>{0, 2});
    CHECK(row_of(cause.strongest.first, rows) < 210);
    CHECK(row_of(cause.strongest.last, rows) > 150);
  }
  CHECK(found >= 16);
  CHECK(find_common_cause(MatrixXd::Ones(rows, 1), 0).outputs.empty());
}

TEST_CASE("a line is told at its frequency, also where rows are missing; white noise has none") {
  int told = 0;
  int missed = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Draws draws(seed);
    MatrixXd white = draw_outputs("white", 2, draws);
    std::vector<double> time = even_times(0.25);
    for (std::size_t i = 200; i < time.size(); ++i) time[i] += 0.25 * 9.0;
    const EvenGrid grid = place_on_grid(time);
    told += find_line(white, grid).p_value < 0.05 ? 1 : 0;
    for (Index i = 0; i < rows; ++i) {  // ten sigmas, 0.35 Hz
      const double turn = 2.0 * std::numbers::pi * 0.35 * time[static_cast<std::size_t>(i)];
      white(i, 1) += 10.0 * std::sqrt(2.0 / rows) * std::sin(turn + 1.0);
    }
    const SpectralLine line = find_line(white, grid);
    missed += line.p_value < 0.0034 ? 0 : 1;
    CHECK(line.frequency / grid.interval == Approx(0.35).epsilon(0.02));
    CHECK(line.outputs.back() == 1);
  }
  CHECK(told <= 4);  // of 20 at 0.05, with odds of 1 in 400
  CHECK(missed <= 3);
}

TEST_CASE("a resonance of a tenth of its critical damping is no line") {
  int told = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Draws draws(seed);
    const double turn = 2.0 * std::numbers::pi * 0.09;  // of a row: 36 turns in the record
    const double radius = std::exp(-0.1 * turn);
    const VectorXd white = draw_noise("white", 2 * rows, draws);
    VectorXd x = VectorXd::Zero(2 * rows);
    for (Index t = 2; t < x.size(); ++t) {
      x[t] = 2.0 * radius * std::cos(turn) * x[t - 1] - radius * radius * x[t - 2] + white[t];
    }
    told += find_line(x.tail(rows), place_on_grid(even_times(1.0))).p_value < 0.01 ? 1 : 0;
  }
  CHECK(told <= 3);
}

TEST_CASE("a line where an input's slope swings is the input's own, elsewhere it is not") {
  const EvenGrid grid = place_on_grid(even_times(1.0));
  MatrixXd slopes(2 * rows, 2);  // the second input turns slowly in the second output
  slopes.col(0).setOnes();
  slopes.col(1) << VectorXd::Zero(rows), VectorXd::LinSpaced(rows, 0.0, 40.0).array().cos();
  const double turning = 40.0 / (2.0 * std::numbers::pi * (rows - 1));
  for (const double away : {0.0, 4.0, 12.0, 60.0}) {
    const double frequency = turning + away / rows;
    const bool near = away < 7.0;
    const SpectralLine of_second{.outputs = {0, 1}, .frequency = frequency};
    CHECK(swings_as_inputs(of_second, slopes, grid) == near);
    CHECK_FALSE(swings_as_inputs({.outputs = {0}, .frequency = frequency}, slopes, grid));
  }
  CHECK_FALSE(swings_as_inputs({.outputs = {0}, .frequency = 0.1}, MatrixXd(2 * rows, 0), grid));
}

TEST_CASE("a swing for a quarter of the record is strongest there") {
  Draws draws(5);
  MatrixXd white = draw_outputs("white", 1, draws);
  white.col(0) += 3.0 * swing(0.2, 100, 200);
  const SpectralLine line = find_line(white, place_on_grid(even_times(1.0)));
  CHECK(row_of(line.strongest.first, rows) == 100);
  CHECK(row_of(line.strongest.last, rows) == 200);
  const VectorXd quarter = white.col(0).segment(100, 100);
  const EvenGrid grid = place_on_grid(even_times(1.0));
  CHECK(strongest_frequency(quarter, grid, 100) == Approx(0.2).epsilon(0.02));
  CHECK(std::isnan(strongest_frequency(draw_noise("white", 100, draws), grid, 100)));
}

TEST_CASE("rows stand on an even grid where stamps jitter, are missing, or begin anew") {
  const auto cells = [](const std::vector<double>& time) { return place_on_grid(time).cells; };
  CHECK(cells({0.0, 0.1, 0.2, 0.5, 0.6}) == std::vector<Index>{0, 1, 2, 5, 6});
  CHECK(cells({0.0, 0.11, 0.19, 0.3, 0.42}) == std::vector<Index>{0, 1, 2, 3, 4});
  CHECK(cells({0.0, 0.1, 0.2, 0.0, 0.1}) == std::vector<Index>{0, 1, 2, 3, 4});
  CHECK(cells({0.0, 1.0, 2.0, 1e6, 1e6 + 1.0}) == std::vector<Index>{0, 1, 2, 66, 67});
  CHECK(place_on_grid({5.0}).length() == 0);
}

TEST_CASE("causes and offsets are corrected together, and the significant are kept") {
  Omnibus offsets{.p_value = 0.004};
  std::vector<UnmeasuredCause> causes{{.kind = UnmeasuredKind::common_cause, .p_value = 0.5},
                                      {.kind = UnmeasuredKind::spectral_line, .p_value = 0.003}};
  correct_together(0.01, offsets, causes);
  REQUIRE(causes.size() == 1);
  CHECK(causes.front().kind == UnmeasuredKind::spectral_line);
  CHECK(causes.front().p_adjusted == Approx(0.009));
  CHECK(offsets.p_adjusted == Approx(0.009));  // 2 x 0.004 is less than what came before it
  CHECK(offsets.significant);
  causes.front().p_value = 0.02;
  offsets.p_value = 1.0;
  correct_together(0.01, offsets, causes);
  CHECK(causes.empty());
  CHECK(!offsets.significant);
  CHECK(to_string(UnmeasuredKind::common_cause) == "common_cause");
  CHECK(to_string(UnmeasuredKind::spectral_line) == "spectral_line");
}

}  // namespace unmeasured_test
