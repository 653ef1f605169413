// SPDX-License-Identifier: BSD-3-Clause
// Standard errors where process noise drives a state that the fit integrates without it: closed
// forms of a random walk, and sums over all pairs of rows written out.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "trajectories.hpp"

namespace process_noise_test {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Affine;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::Quantity;
using sepcal::Rate;
using sepcal::Record;
using sepcal::TrajectoryModel;
using sepcal::Vec;

/// x' = white noise, read as it is; the level x_0 is all there is to estimate.
struct Walk {
  static constexpr std::array<Quantity, 0> inputs{};
  static constexpr std::array states{Quantity{"x", "m"}};
  static constexpr std::array outputs{Quantity{"x_m", "m"}};
  static constexpr std::array<Quantity, 0> linear{};
  static constexpr std::array<Quantity, 0> nonlinear{};
  static constexpr std::array noise{Quantity{"push", "m/s/sqrt(Hz)"}};

  template <class U, class X>
  Rate<X, 1> rate(const Vec<X, 1>& /*x*/, const Vec<U, 0>& /*u*/, const Vec<X, 0>& /*p*/) const {
    return Rate<X, 1>::Zero();
  }
  template <class U, class X>
  Eigen::Matrix<X, 1, 1> noise_input(const Vec<X, 1>& /*x*/, const Vec<U, 0>& /*u*/,
                                     const Vec<X, 0>& /*p*/) const {
    return Eigen::Matrix<X, 1, 1>::Constant(X(1.0));
  }
  template <class U, class X>
  Affine<X, 1, 0> at(const Vec<X, 1>& x, const Vec<U, 0>& /*u*/, const Vec<X, 0>& /*p*/) const {
    Affine<X, 1, 0> z;
    z.b = x;
    return z;
  }
  Vec<double, 1> start(const Vec<double, 0>& /*u*/, const Vec<double, 1>& z) const { return z; }
};

/// Shaken by a noise of its own force.
struct Shaken : sepcal::test::Oscillator {
  static constexpr std::array noise{Quantity{"force", "m/s^2/sqrt(Hz)"}};

  template <class U, class X>
  Eigen::Matrix<X, 2, 1> noise_input(const Vec<X, 2>& /*x*/, const Vec<U, 1>& /*u*/,
                                     const Vec<X, 3>& /*p*/) const {
    return Eigen::Matrix<X, 2, 1>(X(0.0), X(1.0));
  }
};

Record walk_record(int rows, double dt, double push, double noise, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> time;
  std::vector<double> z;
  double x = 3.0;
  for (int k = 0; k < rows; ++k) {
    time.push_back(dt * k);
    z.push_back(x + noise * normal(random));
    x += push * std::sqrt(dt) * normal(random);
  }
  Record record;
  record.add("time", time);
  record.add("x_m", z);
  return record;
}

FitOptions shaken_by(double push) {
  return {.noise = {{"x_m", 0.5}}, .coloured_errors = false, .process_noise = {{"push", push}}};
}

/// The variance of the mean of N readings of a random walk: sigma^2 / N, and a push's share of the
/// N - j readings after it.
double variance_of_level(int N, double sigma, double variance_a_step) {
  double sum = 0.0;
  for (int j = 1; j < N; ++j) sum += std::pow(static_cast<double>(N - j) / N, 2);
  return sigma * sigma / N + variance_a_step * sum;
}

}  // namespace

TEST_CASE("the level of a random walk is as uncertain as its closed form says") {
  for (const int rows : {5, 40, 700}) {
    CAPTURE(rows);
    const Record record = walk_record(rows, 0.1, 0.2, 0.5, 1);
    const TrajectoryModel<Walk> model(Walk{}, record);
    const Fit fit = sepcal::fit(model, record, shaken_by(0.2));
    CHECK(fit.covariance(0, 0) ==
          doctest::Approx(variance_of_level(rows, 0.5, 0.04 * 0.1)).epsilon(1e-9));
    CHECK(fit.parameters[0].standard_error == std::sqrt(fit.covariance(0, 0)));
    CHECK(fit.parameters[0].standard_error_white ==
          doctest::Approx(0.5 / std::sqrt(rows)).epsilon(1e-9));
    CHECK((fit.message.find("process noise makes standard errors up to") != std::string::npos) ==
          (fit.parameters[0].standard_error > 1.1 * fit.parameters[0].standard_error_white));
  }
}

TEST_CASE("of 400 random walks 95 % of intervals hold") {
  int held = 0;
  int held_without = 0;
  for (unsigned seed = 0; seed < 400; ++seed) {
    const Record record = walk_record(60, 0.1, 0.4, 0.5, 100 + seed);
    const TrajectoryModel<Walk> model(Walk{}, record);
    const Fit fit = sepcal::fit(model, record, shaken_by(0.4));
    const double off = std::abs(fit.parameters[0].value - 3.0);
    if (off < 1.96 * fit.parameters[0].standard_error) ++held;
    if (off < 1.96 * fit.parameters[0].standard_error_white) ++held_without;
  }
  // 95 % of 400 leaves 366 to 392 once in a thousand.
  CHECK(held >= 366);
  CHECK(held <= 393);
  CHECK(held_without < 200);
}

TEST_CASE("the score's covariance is the sum over all pairs of rows, pieces and blocks apart") {
  constexpr int rows = 300;
  std::vector<double> time;
  std::vector<double> u;
  for (int k = 0; k < rows; ++k) {
    time.push_back(0.02 * k + 0.004 * (k % 3));
    u.push_back(std::sin(0.7 * time.back()));
  }
  Record record;
  record.add("time", time);
  record.add("u", u);
  record.add("x_m", std::vector<double>(rows, 0.0));
  record.add("v_m", std::vector<double>(rows, 0.0));
  for (const double shoot : {sepcal::infinity, 2.5}) {
    CAPTURE(shoot);
    const TrajectoryModel<Shaken> model(Shaken{}, record, {.shoot = shoot});
    const auto n = static_cast<Index>(model.tables().parameters().size());
    VectorXd xi = VectorXd::LinSpaced(n, 0.3, 0.9);
    xi[2] = 2.0;
    const VectorXd noise(Eigen::Vector2d(0.2, 0.5));
    const double density = 0.3;

    const VectorXd xi1 = xi.head(2);
    const MatrixXd all = sepcal::test::rows_of(model, record, xi.tail(n - 2), &xi1);
    const auto steps = model.steps(record, xi);
    MatrixXd expected = MatrixXd::Zero(n, n);
    // A push from row j to the next, its mean or its slope: its mark on every later reading of its
    // piece, summed.
    std::vector<sepcal::StateSteps::Step> taken;
    std::vector<MatrixXd> H;
    std::vector<int> piece;
    VectorXd x;
    for (std::size_t k = 0; k < rows; ++k) {
      const int begun = model.plan().trajectory_at(k, k == 0);
      if (begun >= 0) {
        x = VectorXd(2);
        for (int i = 0; i < 2; ++i) x[i] = xi[model.plan().column_of_start(i, begun)];
      }
      piece.push_back(begun >= 0 ? begun : piece.back());
      H.push_back(steps->read(k, x).H);
      if (k + 1 == rows) break;
      taken.push_back(steps->advance(k, x));
      x = taken.back().x;
    }
    for (std::size_t part = 0; part < 2 * (rows - 1); ++part) {
      const std::size_t j = part / 2;
      MatrixXd mark = taken[j].Gamma.col(static_cast<Index>(part % 2));  // 2 x 1
      VectorXd score = VectorXd::Zero(n);
      for (std::size_t k = j + 1; k < rows && piece[k] == piece[j]; ++k) {
        for (Index output = 0; output < 2; ++output) {
          const auto row = output * rows + static_cast<Index>(k);
          const double e = (H[k].row(output) * mark)(0, 0);
          score += all.row(row).head(n).transpose() * e / (noise[output] * noise[output]);
        }
        if (k + 1 < rows) mark = taken[k].Phi * mark;
      }
      expected += score * score.transpose() * density * density / (time[j + 1] - time[j]);
    }
    const MatrixXd found = model.score_noise(record, xi, noise, VectorXd::Constant(1, density));
    CHECK((found - expected).norm() < 1e-10 * expected.norm());
  }
}

TEST_CASE("process noise of other models is refused by name") {
  const Record record = walk_record(30, 0.1, 0.2, 0.5, 1);
  const TrajectoryModel<Walk> model(Walk{}, record);
  CHECK_THROWS_WITH_AS(sepcal::fit(model, record, {.process_noise = {{"pull", 1.0}}}),
                       "the model has no process noise 'pull'; it has push", sepcal::Error);
  CHECK_THROWS_WITH_AS(sepcal::fit(model, record, {.process_noise = {{"push", -1.0}}}),
                       "process noise 'push' needs a standard deviation of 0 or more",
                       sepcal::Error);
}

TEST_CASE("initial states of segments that are left out are held where they are read") {
  Record record = walk_record(60, 0.1, 0.0, 0.5, 1);
  record.cut({{"one", 0, 30}, {"two", 30, 60}});
  const TrajectoryModel<Walk> model(Walk{}, record);
  const Fit fit = sepcal::fit(model, record, {.stage_two_segments = "two"});
  CHECK(fit.status == sepcal::FitStatus::converged);
  REQUIRE(fit.parameters[0].name == "x_0[one]");
  CHECK(fit.parameters[0].fixed);
  CHECK(fit.parameters[0].value == record.column("x_m")[0]);
  CHECK_FALSE(fit.parameters[1].fixed);
}

}  // namespace process_noise_test
