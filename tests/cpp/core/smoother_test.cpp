// SPDX-License-Identifier: BSD-3-Clause
// Single-stage and multistage smoothing, states and noises, against conditioning of the stacked
// Gaussian vector.
#include "sepcal/states/smoother.hpp"

#include <doctest/doctest.h>

#include <array>

#include "sepcal/states/filter.hpp"
#include "stacked_system.hpp"

namespace smoother_test {

using sepcal::Estimate;
using sepcal::Filter;
using sepcal::LinearDynamics;
using sepcal::LinearOutputs;
using sepcal::test::Conditioning;
using sepcal::test::Draws;
using sepcal::test::Gaussian;
using sepcal::test::RandomSystem;

namespace {

constexpr int n = RandomSystem::n;
constexpr int m = RandomSystem::m;
constexpr int n_w = RandomSystem::n_w;
constexpr int samples = RandomSystem::samples;
using Stage = sepcal::Stage<n, n_w>;
using Smoothed = sepcal::Smoothed<n, n_w>;

std::array<Stage, samples> filter_all(const RandomSystem& system) {
  std::array<Stage, samples> pass;
  Filter<n> filter(system.x0, system.P0);
  for (std::size_t k = 0; k < samples; ++k) {
    const auto& at = system.at[k];
    filter.update(at.y, LinearOutputs<m, n>{at.C}.at(filter.x(), at.D * at.u), at.R);
    const LinearDynamics<n, n_w> dynamics{at.Phi, at.Gamma, at.Q};
    pass[k] = {filter.estimate(), dynamics.from(filter.x(), at.Psi * at.u)};
    filter.predict(pass[k].next);
  }
  return pass;
}

double distance(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance,
                const Gaussian& expected) {
  return std::max((mean - expected.mean).norm() / (1.0 + expected.mean.norm()),
                  (covariance - expected.covariance).norm() / expected.covariance.norm());
}

double distance(const Smoothed& smoothed, const Conditioning& conditioning, int k, int until) {
  return std::max(distance(smoothed.x, smoothed.P, conditioning.state(k, until)),
                  distance(smoothed.w, smoothed.Q, conditioning.noise(k, until)));
}

RandomSystem with_losses(std::uint64_t seed) {
  RandomSystem system(seed);
  system.lose(1, 0);
  system.lose(4, 0);
  system.lose(4, 1);
  return system;
}

}  // namespace

TEST_CASE("single-stage smoothing in both forms is conditioning on one sample more") {
  double second = 0.0;
  double first = 0.0;
  for (const RandomSystem& system : {RandomSystem(1), RandomSystem(2), with_losses(3)}) {
    const Conditioning conditioning(system);
    const auto pass = filter_all(system);
    for (int k = 0; k + 1 < samples; ++k) {
      const Stage& stage = pass[static_cast<std::size_t>(k)];
      const Estimate<n>& later = pass[static_cast<std::size_t>(k) + 1].filtered;
      const Smoothed smoothed = sepcal::smooth_stage(stage, later.x, later.covariance());
      second = std::max(second, distance(smoothed, conditioning, k, k + 1));
      const auto& at = system.at[static_cast<std::size_t>(k) + 1];
      const auto means = sepcal::smooth_by_residual(
          stage, at.y, LinearOutputs<m, n>{at.C}.at(later.x, at.D * at.u), at.R);
      first = std::max({first, distance(means.x, smoothed.P, conditioning.state(k, k + 1)),
                        distance(means.w, smoothed.Q, conditioning.noise(k, k + 1))});
    }
  }
  MESSAGE("single-stage smoothing from conditioning: " << second << ", by residuals " << first);
  CHECK(second < 1e-10);
  CHECK(first < 1e-10);
}

TEST_CASE("multistage smoothing is conditioning on all samples, w(k|N) and Q(k|N) too") {
  double worst = 0.0;
  double closure = 0.0;
  for (const RandomSystem& system : {RandomSystem(4), RandomSystem(5), with_losses(6)}) {
    const Conditioning conditioning(system);
    const auto pass = filter_all(system);
    std::array<Smoothed, samples> smoothed;
    sepcal::smooth(pass, smoothed);
    for (int k = 0; k < samples; ++k) {
      const Smoothed& here = smoothed[static_cast<std::size_t>(k)];
      worst = std::max(worst, distance(here, conditioning, k, samples - 1));
      if (k + 1 == samples) continue;
      const auto& at = system.at[static_cast<std::size_t>(k)];
      const Eigen::Vector3d next = at.Phi * here.x + at.Psi * at.u + at.Gamma * here.w;
      closure = std::max(closure, (next - smoothed[static_cast<std::size_t>(k) + 1].x).norm());
    }
  }
  MESSAGE("multistage smoothing from conditioning: " << worst << ", x(k+1|N) " << closure);
  CHECK(worst < 1e-10);
  CHECK(closure < 1e-12);
}

TEST_CASE("states without noise, also known ones: P(k+1|k) is singular and nothing breaks") {
  RandomSystem system(7);
  for (auto& at : system.at) {
    at.Phi.row(2) << 0.0, 0.0, 1.0;  // a constant that is known
    at.Phi(0, 1) = 0.0;              // state 0 has no noise and is not known
    at.Gamma.row(2).setZero();
    at.Gamma.row(0).setZero();
    at.Psi(2, 0) = 0.0;
    at.Q << 4.0, 2.0, 2.0, 1.0;
  }
  system.P0.row(2).setZero();
  system.P0.col(2).setZero();
  const Conditioning conditioning(system);
  const auto pass = filter_all(system);
  std::array<Smoothed, samples> smoothed;
  sepcal::smooth(pass, smoothed);
  for (int k = 0; k < samples; ++k) {
    CHECK(distance(smoothed[static_cast<std::size_t>(k)], conditioning, k, samples - 1) < 1e-9);
  }
}

TEST_CASE("a vague start: smoothed covariances stay positive and true") {
  // A random walk with a first state of sd 1e5, seen to 1e-5: x(0|N) as of a fit without P(0).
  constexpr int rows = 5;
  constexpr double r = 1e-5;
  using One = Eigen::Matrix<double, 1, 1>;
  using Number = Eigen::Vector<double, 1>;
  Draws draws(8);
  std::array<sepcal::Stage<1>, rows> pass;
  Filter<1> filter(Number(0.0), One(1e10));
  for (auto& stage : pass) {
    filter.update(Number(1.0 + r * draws.normal()),
                  LinearOutputs<1, 1>{One(1.0)}.at(filter.x(), Number(0.0)), One(r * r));
    stage = {filter.estimate(),
             LinearDynamics<1>{One(1.0), One(1.0), One(r * r)}.from(filter.x(), Number(0.0))};
    filter.predict(stage.next);
  }
  // Information of x(0) in units of 1/r^2: from the last sample back, i <- 1 + i / (1 + i).
  double information = 1.0;
  for (int k = 1; k < rows; ++k) information = 1.0 + information / (1.0 + information);
  std::array<sepcal::Smoothed<1>, rows> smoothed;
  sepcal::smooth(pass, smoothed);
  CHECK(smoothed[0].P(0, 0) == doctest::Approx(r * r / information).epsilon(1e-9));
  CHECK(smoothed[0].Q(0, 0) > 0.0);
}

}  // namespace smoother_test
