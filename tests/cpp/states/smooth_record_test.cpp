// SPDX-License-Identifier: BSD-3-Clause
// Smoothing along a record: a random walk, whose precision given everything is a band matrix.
#include "sepcal/states/smooth_record.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>

#include "sepcal/error.hpp"
#include "sepcal/states/trajectory_model.hpp"

namespace smooth_record_test {

using doctest::Approx;
using doctest::Contains;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Error;
using sepcal::Quantity;
using sepcal::Record;
using sepcal::SmoothingNoise;
using sepcal::TrajectoryModel;

namespace {

/// x' = u + w, read with a bias.
struct Walk {
  static constexpr std::array inputs{Quantity{"u", "m/s"}};
  static constexpr std::array states{Quantity{"x", "m"}};
  static constexpr std::array outputs{Quantity{"x_m", "m"}};
  static constexpr std::array linear{Quantity{"b", "m"}};
  static constexpr std::array<Quantity, 0> nonlinear{};
  static constexpr std::array noise{Quantity{"x", "m/sqrt(s)"}};

  template <class U, class X>
  sepcal::Rate<X, 1> rate(const sepcal::Vec<X, 1>& /*x*/, const sepcal::Vec<U, 1>& u,
                          const sepcal::Vec<X, 0>& /*p*/) const {
    sepcal::Rate<X, 1> dx;
    dx[0] = X(u[0]);
    return dx;
  }
  template <class U, class X>
  sepcal::Affine<X, 1, 1> at(const sepcal::Vec<X, 1>& x, const sepcal::Vec<U, 1>& /*u*/,
                             const sepcal::Vec<X, 0>& /*p*/) const {
    sepcal::Affine<X, 1, 1> z;
    z.A << X(1.0);
    z.b = x;
    return z;
  }
};

/// The same that nothing disturbs.
struct Line : Walk {
  static constexpr std::array<Quantity, 0> noise{};
};

constexpr double lost = std::numeric_limits<double>::quiet_NaN();
const std::vector<double> stamps{0.0, 0.1, 0.3, 0.35, 0.6, 1.0, 1.1};  // s
const std::vector<double> measured{1.2, 1.0, lost, 1.4, 1.7, lost, 2.2};
constexpr double speed = 0.8;    // u, m/s
constexpr double density = 0.5;  // m/sqrt(s)
constexpr double sigma = 0.2;    // m
constexpr double spread = 0.7;   // of x(0), m
const std::map<std::string, double> parameters{{"b", 0.1}, {"x_0", 0.9}};

Record record_of(const std::vector<double>& outputs) {
  Record record;
  record.add("time", stamps)
      .add("u", std::vector<double>(stamps.size(), speed))
      .add("x_m", outputs);
  return record;
}

SmoothingNoise noise() {
  return {.process = {{"x", density}}, .outputs = {{"x_m", sigma}}, .start = {{"x", spread}}};
}

}  // namespace

TEST_CASE("a random walk is smoothed as its precision has it, rows uneven, readings missing") {
  const Record record = record_of(measured);
  const TrajectoryModel model(Walk{}, record);
  const sepcal::SmoothedRecord found = smooth(model, record, parameters, noise());

  const auto N = static_cast<Index>(stamps.size());
  MatrixXd precision = MatrixXd::Zero(N, N);
  VectorXd pull = VectorXd::Zero(N);  // about the path without noise
  const auto path = [](Index k) { return 0.9 + speed * stamps[static_cast<std::size_t>(k)]; };
  precision(0, 0) = 1.0 / (spread * spread);
  std::size_t readings = 0;
  for (Index k = 0; k < N; ++k) {
    const auto row = static_cast<std::size_t>(k);
    if (!std::isnan(measured[row])) {
      precision(k, k) += 1.0 / (sigma * sigma);
      pull[k] += (measured[row] - 0.1 - path(k)) / (sigma * sigma);
      ++readings;
    }
    if (k + 1 == N) break;
    const double weight = 1.0 / (density * density * (stamps[row + 1] - stamps[row]));
    precision.block<2, 2>(k, k) += weight * (MatrixXd(2, 2) << 1, -1, -1, 1).finished();
  }
  const MatrixXd covariance = precision.inverse();
  const VectorXd mean = covariance * pull;
  for (Index k = 0; k < N; ++k) {
    const auto row = static_cast<std::size_t>(k);
    CHECK(found.x(k, 0) == Approx(path(k) + mean[k]).epsilon(1e-12));
    CHECK(found.P[row](0, 0) == Approx(covariance(k, k)).epsilon(1e-11));
    CHECK(std::isnan(found.innovations(k, 0)) == std::isnan(measured[row]));
    if (k + 1 == N) break;
    const double dt = stamps[row + 1] - stamps[row];
    const double step = covariance(k, k) + covariance(k + 1, k + 1) - 2.0 * covariance(k, k + 1);
    CHECK(found.w(k, 0) == Approx((mean[k + 1] - mean[k]) / dt).epsilon(1e-11));
    CHECK(found.Q[row](0, 0) == Approx(step / (dt * dt)).epsilon(1e-10));
  }
  CHECK(found.readings == readings);
  CHECK(found.w(N - 1, 0) == 0.0);
}

TEST_CASE("segments are smoothed alone, and rows outside stay empty") {
  std::vector<double> outputs = measured;
  Record record = record_of(outputs);
  record.cut({{"one", 0, 3}, {"two", 4, 7}});
  const TrajectoryModel model(Walk{}, record);
  const std::map<std::string, double> both{{"b", 0.1}, {"x_0[one]", 0.9}, {"x_0[two]", 1.5}};
  const sepcal::SmoothedRecord found = smooth(model, record, both, noise());
  CHECK(std::isnan(found.x(3, 0)));
  CHECK(std::isnan(found.P[3](0, 0)));
  const double gain = spread * spread / (spread * spread + sigma * sigma);
  CHECK(found.innovations(4, 0) == Approx(1.7 - 0.1 - 1.5));
  CHECK(found.innovation_sd(4, 0) == Approx(std::hypot(spread, sigma)));
  CHECK(found.innovations(6, 0) ==
        Approx(2.2 - 0.1 - (1.5 + gain * 0.1 + speed * (stamps[6] - stamps[4]))).epsilon(1e-12));
}

TEST_CASE("what can't be smoothed is said in one line") {
  const Record record = record_of(measured);
  const TrajectoryModel model(Walk{}, record);
  const auto refuse = [&](const SmoothingNoise& given, const char* words) {
    CHECK_THROWS_WITH_AS(smooth(model, record, parameters, given), Contains(words), Error);
  };
  SmoothingNoise spoiled = noise();
  spoiled.process = {};
  refuse(spoiled, "no process noise is given");
  spoiled.process = {{"y", 1.0}};
  refuse(spoiled, "there is no process noise 'y'; the model has: x");
  spoiled.process = {{"x", 0.0}};
  refuse(spoiled, "must be a positive standard deviation");
  spoiled = noise();
  spoiled.outputs = {};
  refuse(spoiled, "the noise of output 'x_m' is not given");
  CHECK_THROWS_WITH_AS(smooth(TrajectoryModel(Line{}, record), record, parameters, noise()),
                       Contains("its table `noise` is empty"), Error);
  CHECK_THROWS_WITH_AS(smooth(model, record, {{"b", 0.1}}, noise()),
                       Contains("parameter 'x_0' has no value"), Error);
}

}  // namespace smooth_record_test
