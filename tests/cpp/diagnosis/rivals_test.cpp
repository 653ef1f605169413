// SPDX-License-Identifier: BSD-3-Clause
// The estimators that the two-stage one is measured against: closed forms, exact recovery without
// noise, and what is theirs to get wrong.
#include <doctest/doctest.h>

#include <Eigen/LU>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/detail/rivals/alonso_shuster.hpp"
#include "sepcal/detail/rivals/haupt_kasdin.hpp"
#include "sepcal/detail/rivals/single_stage.hpp"
#include "sepcal/detail/rivals/two_step_problems.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/static_model.hpp"

namespace rivals_test {

using doctest::Approx;
using doctest::Contains;
using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using sepcal::Error;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::Record;
using sepcal::ScalarExample1;
using sepcal::StaticModel;
using namespace sepcal::rivals;

namespace {

/// The paper's Sec. III: a = c = 1, b = 0.1, 100 angles from 1 to 10 rad.
Record waves(double sigma, unsigned seed = 1) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<double> eta(100);
  std::vector<double> z(100);
  for (std::size_t k = 0; k < eta.size(); ++k) {
    eta[k] = 1.0 + 9.0 * static_cast<double>(k) / 99.0;
    z[k] = 2.0 * std::cos(eta[k] + 0.1) + 1.0 + sigma * noise(generator);
  }
  Record record;
  record.add("eta", std::move(eta));
  record.add("z", std::move(z));
  return record;
}

/// C = C_alpha C_lambda of (lambda, alpha).
Matrix3d sensor(const VectorXd& xi) {
  Matrix3d C_alpha;
  C_alpha << 1.0, xi[3], xi[4], xi[3], 1.0, xi[5], xi[4], xi[5], 1.0;
  return C_alpha * Vector3d(1.0 + xi[0], 1.0 + xi[1], 1.0 + xi[2]).asDiagonal();
}

const VectorXd magnetometer_truth{{0.04, -0.03, 0.02, 0.02, -0.015, 0.01, 12.0, -7.0, 5.0}};
constexpr double strength = 53.0;  // uT

/// Readings all round the sphere, on Fibonacci's spiral.
Record tumbles(const VectorXd& xi, double sigma, int rows = 300, unsigned seed = 1) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<std::vector<double>> axes(3);
  for (int k = 0; k < rows; ++k) {
    const double z = 1.0 - (2.0 * k + 1.0) / rows;
    const double turn = std::numbers::pi * (1.0 + std::sqrt(5.0)) * k;
    const double r = std::sqrt(1.0 - z * z);
    const Vector3d h(r * std::cos(turn), r * std::sin(turn), z);
    const Vector3d m = sensor(xi) * (strength * h) + xi.tail<3>();
    for (Index axis = 0; axis < 3; ++axis) {
      axes[static_cast<std::size_t>(axis)].push_back(m[axis] + sigma * noise(generator));
    }
  }
  Record record;
  record.add("mx", axes[0]);
  record.add("my", axes[1]);
  record.add("mz", axes[2]);
  return record;
}

double largest_difference(const VectorXd& one, const VectorXd& other) {
  return (one - other).cwiseAbs().maxCoeff();
}

}  // namespace

TEST_CASE("the single stage finds the minimum that the two stages find") {
  const Record record = waves(0.3);
  const Fit fit = sepcal::fit(ScalarExample1{}, record);
  for (const Solver solver : {Solver::levenberg_marquardt, Solver::slsqp}) {
    SingleStageOptions options;
    options.solver = solver;
    options.noise_tolerance = 1e-10;
    const SingleStageFit single =
        fit_single_stage(ScalarExample1{}, record, {{"a", 0.3}, {"b", -0.1}}, options);
    CHECK(single.converged);
    CHECK(single.names == std::vector<std::string>{"a", "c", "b"});
    CHECK(largest_difference(single.estimates, fit.values()) < 1e-5);
    CHECK(single.cost == Approx(fit.cost).epsilon(1e-9));
    CHECK(single.noise[0].value == Approx(fit.noise[0].value).epsilon(1e-6));
  }
}

TEST_CASE("a start beyond pi ends in the mirror, within bounds it does not") {
  const Record record = waves(0.3);
  SingleStageOptions options;
  options.bounds["b"] = {-10.0, 10.0};
  const SingleStageFit mirror =
      fit_single_stage(ScalarExample1{}, record, {{"a", -3.0}, {"c", 1.0}, {"b", 3.0}}, options);
  CHECK(mirror.converged);
  CHECK(1.0 + mirror.estimates[0] < 0.0);  // -(1 + a), and half a turn
  const SingleStageFit near = fit_single_stage(ScalarExample1{}, record, {}, options);
  CHECK(mirror.cost == Approx(near.cost).epsilon(1e-6));
}

TEST_CASE("held parameters, a given R, and refusals of the single stage") {
  const Record record = waves(0.3);
  SingleStageOptions options;
  options.fix["c"] = 1.0;
  options.noise["z"] = 0.3;
  const SingleStageFit single = fit_single_stage(ScalarExample1{}, record, {}, options);
  CHECK(single.estimates[1] == 1.0);
  CHECK(single.noise[0].value == 0.3);
  CHECK(single.noise_iterations == 0);
  CHECK_THROWS_WITH_AS(fit_single_stage(ScalarExample1{}, record, {{"d", 1.0}}),
                       Contains("there is no parameter 'd'; there are: a, c, b"), Error);
}

TEST_CASE("three states of the first example have a closed form") {
  const Record record = waves(0.3);
  const HauptKasdinFit fit = fit_haupt_kasdin(ExampleInThreeStates{}, record, {});
  CHECK(fit.converged);
  CHECK(fit.first.rank == 3);
  const VectorXd& y = fit.first.states;
  CHECK(fit.estimates[0] == Approx(std::hypot(y[0], y[1]) - 1.0).epsilon(1e-8));
  CHECK(fit.estimates[1] == Approx(y[2]).epsilon(1e-8));
  CHECK(fit.estimates[2] == Approx(std::atan2(y[1], y[0])).epsilon(1e-8));
  CHECK(fit.cost < 1e-12);  // as many states as parameters
  // and it is the maximum-likelihood estimate, with its standard errors
  FitOptions white;
  white.coloured_errors = false;
  const Fit two_stage = sepcal::fit(ScalarExample1{}, record, white);
  CHECK(largest_difference(fit.estimates, two_stage.values()) < 1e-7);
  for (Index k = 0; k < 3; ++k) {
    const double standard_error =
        two_stage.parameters[static_cast<std::size_t>(k)].standard_error * std::sqrt(97.0 / 100.0);
    CHECK(fit.standard_errors[k] == Approx(standard_error).epsilon(1e-6));
  }
}

TEST_CASE("the paper's five states repeat columns: rank three, and the same cost") {
  const Record record = waves(0.3);
  const HauptKasdinFit fit = fit_haupt_kasdin(ExampleInFiveStates{}, record, {});
  CHECK(fit.first.rank == 3);
  CHECK(fit.first.condition > 1e10);
  CHECK(fit.converged);
  const HauptKasdinFit three = fit_haupt_kasdin(ExampleInThreeStates{}, record, {});
  CHECK(largest_difference(fit.estimates, three.estimates) < 1e-6);
  // Eq. 32 weighted by the information is the sum of squares of z less a constant.
  const VectorXd& y = fit.first.states;
  const auto second = [&](const VectorXd& xi) {
    const VectorXd e =
        y - VectorXd(ExampleInFiveStates::states_at<double>(sepcal::Vec<double, 3>(xi)));
    return e.dot(fit.first.information * e);
  };
  const auto squares = [&](const VectorXd& xi) {
    double sum = 0.0;
    const auto eta = record.column("eta");
    const auto z = record.column("z");
    for (std::size_t k = 0; k < eta.size(); ++k) {
      const double r = z[k] - (1.0 + xi[0]) * std::cos(eta[k] + xi[2]) - xi[1];
      sum += r * r;
    }
    return sum / (fit.first.noise[0].value * fit.first.noise[0].value);
  };
  const VectorXd here{{0.5, 0.2, 0.4}};
  const VectorXd there{{-2.0, 1.5, 2.0}};
  CHECK(second(here) - second(there) == Approx(squares(here) - squares(there)).epsilon(1e-9));
}

TEST_CASE("a first step must be linear, and have the states of the change") {
  const Record record = waves(0.3);
  const StaticChange<ExampleInThreeStates> change(ExampleInThreeStates{});
  CHECK_THROWS_WITH_AS(
      fit_haupt_kasdin(StaticModel<ScalarExample1>(ScalarExample1{}), record, change, {}),
      Contains("the first step is linear"), Error);
  using Five = FirstStepModel<ExampleInFiveStates>;
  CHECK_THROWS_WITH_AS(fit_haupt_kasdin(StaticModel<Five>(Five{}), record, change, {}),
                       Contains("gives 3 states, the first step has 5"), Error);
}

TEST_CASE("without noise both magnetometer rivals are exact") {
  const Record record = tumbles(magnetometer_truth, 0.0);
  const AlonsoShusterFit twostep = fit_alonso_shuster(record, strength, {.noise = 1e-6});
  CHECK(twostep.converged);
  CHECK(largest_difference(twostep.estimates, magnetometer_truth) < 1e-8);
  const Matrix3d C = sensor(magnetometer_truth);
  CHECK((twostep.shape - C * C.transpose()).norm() < 1e-9);
  const HauptKasdinFit quadric = fit_haupt_kasdin(MagnetometerInNineStates{strength}, record, {},
                                                  {.noise = {{"quadric", 1.0}}});
  CHECK(quadric.converged);
  CHECK(largest_difference(quadric.estimates, magnetometer_truth) < 1e-6);
}

TEST_CASE("TWOSTEP of the bias alone") {
  VectorXd truth = VectorXd::Zero(9);
  truth.tail<3>() << 12.0, -7.0, 5.0;
  const Record record = tumbles(truth, 0.0);
  const AlonsoShusterFit fit =
      fit_alonso_shuster(record, strength, {.noise = 1e-6, .bias_alone = true});
  CHECK(fit.converged);
  CHECK(fit.names == std::vector<std::string>{"n_x", "n_y", "n_z"});
  CHECK(largest_difference(fit.estimates, truth.tail<3>()) < 1e-8);
}

TEST_CASE("TWOSTEP's estimates scatter as its covariance says") {
  constexpr int flights = 200;
  double sum = 0.0;
  for (unsigned seed = 0; seed < flights; ++seed) {
    const Record record = tumbles(magnetometer_truth, 0.1, 300, seed);
    const AlonsoShusterFit fit = fit_alonso_shuster(record, strength, {.noise = 0.1});
    REQUIRE(fit.converged);
    const VectorXd error = fit.estimates - magnetometer_truth;
    sum += error.dot(fit.covariance.inverse() * error);
  }
  // chi-squared with 9 degrees of freedom each: 9 +- 0.3, five of these and the noise in L
  CHECK(sum / flights == Approx(9.0).epsilon(0.17));
}

TEST_CASE("TWOSTEP says what it can't do") {
  const Record record = tumbles(magnetometer_truth, 0.1);
  CHECK_THROWS_WITH_AS(fit_alonso_shuster(record, 0.0), Contains("above zero"), Error);
  CHECK_THROWS_WITH_AS(fit_alonso_shuster(record, strength, {.noise = 0.0}), Contains("above zero"),
                       Error);
  Record flat;
  std::vector<double> x(50);
  std::vector<double> y(50);
  for (std::size_t k = 0; k < 50; ++k) {
    x[k] = strength * std::cos(0.1 * static_cast<double>(k));
    y[k] = strength * std::sin(0.1 * static_cast<double>(k));
  }
  flat.add("mx", x);
  flat.add("my", y);
  flat.add("mz", std::vector<double>(50, 0.0));
  const AlonsoShusterFit fit = fit_alonso_shuster(flat, strength);
  CHECK(!fit.converged);
  CHECK(fit.message == "the readings leave parameters open; cover more of the sphere");
  CHECK(std::isnan(fit.estimates[0]));
}

}  // namespace rivals_test
