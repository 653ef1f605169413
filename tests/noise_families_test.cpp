// SPDX-License-Identifier: BSD-3-Clause
// Both families of noise against dense covariances, and what each finds in noise of known kind.
#include "noise/noise_families.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "noises.hpp"

namespace noise_families_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace sepcal;
using namespace sepcal::test;
using noise::NoiseFamilies;
using noise::NoiseFamily;
using noise::NoiseMember;

namespace {

const std::vector<Segment> runs{{"", 0, 150}, {"", 150, 240}};
constexpr Index rows = 240;

MatrixXd covariance_of(const NoiseFamilies& families, const NoiseMember& member) {
  MatrixXd factor = MatrixXd::Identity(rows, rows);
  for (auto column : factor.colwise()) families.colour(member, column);
  return factor * factor.transpose();
}

double log_determinant(const MatrixXd& matrix) {
  return 2.0 * matrix.llt().matrixLLT().diagonal().array().log().sum();
}

}  // namespace

TEST_CASE("what find() says of a member is its likelihood by the dense covariance") {
  const NoiseFamilies families(runs);
  for (const std::string& kind : noise_kinds) {
    for (const NoiseFamily family : noise::noise_families) {
      CAPTURE(kind);
      Draws draws(4);
      const VectorXd e = draw_noise(kind, rows, draws);
      const NoiseMember member = families.find(family, e, 2);
      const MatrixXd Sigma = covariance_of(families, member);
      const double square = e.dot(Sigma.ldlt().solve(e));
      CHECK(square == Approx(rows).epsilon(1e-6));  // sigma's own estimate
      CHECK(member.minus_two_log_likelihood == Approx(log_determinant(Sigma)).epsilon(1e-6));
      MatrixXd white = e;
      families.whiten(member, white);
      CHECK(white.squaredNorm() == Approx(square).epsilon(1e-6));
    }
  }
}

TEST_CASE("whiten_backwards() is the transpose of a wandering member's whiten()") {
  const NoiseFamilies families(runs);
  Draws draws(11);
  for (const std::string& kind : noise_kinds) {
    const NoiseMember member =
        families.find(NoiseFamily::wandering, draw_noise(kind, rows, draws), 0);
    MatrixXd factor = MatrixXd::Identity(rows, rows);
    families.whiten(member, factor);
    MatrixXd transposed = MatrixXd::Identity(rows, rows);
    for (auto column : transposed.colwise()) families.whiten_backwards(member, column);
    CHECK(transposed.isApprox(factor.transpose(), 1e-12));
  }
}

TEST_CASE("the wandering family is white noise plus Gauss and Markov's, run by run") {
  const NoiseFamilies families(runs);
  Draws draws(9);
  const VectorXd e = draw_noise("AR(0.9)", rows, draws);
  const NoiseMember member = families.find(NoiseFamily::wandering, e, 0);
  const MatrixXd Sigma = covariance_of(families, member);
  const double variance = Sigma(0, 0);
  const double a = Sigma(2, 0) / Sigma(1, 0);
  for (const Index row : {0, 7, 149, 150, 239}) {
    CHECK(Sigma(row, row) == Approx(variance).epsilon(1e-9));
  }
  CHECK(Sigma(60, 20) == Approx(Sigma(1, 0) * std::pow(a, 39)).epsilon(1e-6));
  CHECK(std::abs(Sigma(160, 20)) < 1e-12 * variance);
}

TEST_CASE("each family finds what is its own") {
  const std::vector<Segment> whole{{"", 0, 2000}};
  const NoiseFamilies families(whole);
  Draws draws(6);
  VectorXd wandering = draws.normal_matrix(2000, 1);
  double drift = 0.0;
  for (double& value : wandering) {
    drift = 0.99 * drift + std::sqrt(1.0 - 0.99 * 0.99) * draws.normal_matrix(1, 1)(0, 0);
    value += drift;
  }
  const auto better = [&](const VectorXd& e) {
    return families.find(NoiseFamily::fractional, e, 1).minus_two_log_likelihood -
           families.find(NoiseFamily::wandering, e, 1).minus_two_log_likelihood;
  };
  CHECK(better(wandering) > 0.0);
  CHECK(better(draw_noise("pink", 2000, draws)) < 0.0);
  CHECK(std::abs(better(draw_noise("white", 2000, draws))) < 10.0);
}

}  // namespace noise_families_test
