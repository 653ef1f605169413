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

TEST_CASE("whiten_backwards() is the transpose of whiten()") {
  const NoiseFamilies families(runs);
  Draws draws(11);
  for (const std::string& kind : noise_kinds) {
    for (const NoiseFamily family : noise::noise_families) {
      for (const int order : {0, 1, 3}) {
        CAPTURE(kind);
        CAPTURE(order);
        NoiseMember member = families.find(family, draw_noise(kind, rows, draws), order);
        // Every d of the fractional family; of the other the one that was found.
        const bool fractional = family == NoiseFamily::fractional;
        for (std::size_t k = 0; k < (fractional ? families.fractions() : 1); ++k) {
          if (fractional) member.at = k;
          MatrixXd factor = MatrixXd::Identity(rows, rows);
          families.whiten(member, factor);
          MatrixXd transposed = MatrixXd::Identity(rows, rows);
          for (auto column : transposed.colwise()) families.whiten_backwards(member, column);
          CHECK(transposed.isApprox(factor.transpose(), 1e-10));
        }
      }
    }
  }
}

TEST_CASE("squares by lagged products are those of whitened columns, in runs of any length") {
  const std::vector<Segment> many{{"", 0, 1}, {"", 1, 3}, {"", 3, 7}, {"", 7, 90}, {"", 90, 99}};
  const NoiseFamilies families(many);
  Draws draws(5);
  MatrixXd columns = draws.normal_matrix(99, 3);
  columns.col(1).setOnes();
  columns.col(2) = VectorXd::LinSpaced(99, 0.0, 30.0);
  for (std::size_t at = 0; at < families.fractions(); ++at) {
    for (const VectorXd& partial : {VectorXd(), VectorXd::Constant(1, 0.9).eval(),
                                    VectorXd::LinSpaced(4, 0.7, -0.3).eval()}) {
      CAPTURE(at);
      CAPTURE(partial.size());
      const NoiseMember member{.at = at, .partial = partial};
      MatrixXd white = columns;
      families.whiten(member, white);
      const auto squares = families.lagged_squares(at, columns, static_cast<int>(partial.size()));
      const MatrixXd expected = white.transpose() * white;
      const MatrixXd found = squares.whitened(partial);
      CHECK((found - expected).norm() < 1e-12 * columns.squaredNorm());
      CHECK(squares.is_sound(found));
    }
  }
  // An autoregression that predicts all but a millionth.
  const auto level = NoiseFamilies({{"", 0, 2000}}).lagged_squares(0, MatrixXd::Ones(2000, 1), 1);
  CHECK(!level.is_sound(level.whitened(VectorXd::Constant(1, 0.9999999))));
}

TEST_CASE("the Gauss-Markov family is white noise plus Gauss and Markov's, run by run") {
  const NoiseFamilies families(runs);
  Draws draws(9);
  const VectorXd e = draw_noise("AR(0.9)", rows, draws);
  const NoiseMember member = families.find(NoiseFamily::gauss_markov, e, 0);
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
           families.find(NoiseFamily::gauss_markov, e, 1).minus_two_log_likelihood;
  };
  CHECK(better(wandering) > 0.0);
  CHECK(better(draw_noise("pink", 2000, draws)) < 0.0);
  CHECK(std::abs(better(draw_noise("white", 2000, draws))) < 10.0);
}

}  // namespace noise_families_test
