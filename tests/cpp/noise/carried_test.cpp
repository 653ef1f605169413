// SPDX-License-Identifier: BSD-3-Clause
// S X and X_b' S X_b of noises with a level of their own and of a free one, against what the
// covariance of the whole gives entry by entry.
#include "noise/carried.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace carried_test {

using Eigen::Index;
using Eigen::MatrixXd;
using namespace sepcal;

namespace {

const std::vector<Segment> runs{{"", 0, 31}, {"", 31, 50}};
const std::vector<Index> cuts{0, 12, 40, 50};  // the second goes on across the runs' border
constexpr Index rows = 50;

/// A noise's covariance row by row: X' S X of unit vectors.
template <class Noise>
MatrixXd covariance_of(const Noise& noise) {
  return covariance_product(noise, runs, MatrixXd(MatrixXd::Identity(rows, rows)));
}

template <class Noise>
void check(const Noise& noise) {
  const MatrixXd S = covariance_of(noise);
  MatrixXd X(rows, 2);
  for (Index t = 0; t < rows; ++t) X.row(t) << std::sin(0.3 * static_cast<double>(t)), 1.0;
  const noise::Carried carried = noise::carry(noise, runs, cuts, X);
  const double tolerance = 1e-10 * S.norm();
  CHECK((carried.whole - S * X).norm() < tolerance * X.norm());
  REQUIRE(carried.own.size() == 3);
  for (std::size_t b = 0; b < 3; ++b) {
    const Index first = cuts[b];
    const Index length = cuts[b + 1] - first;
    const MatrixXd own = X.middleRows(first, length).transpose() *
                         S.block(first, first, length, length) * X.middleRows(first, length);
    CHECK((carried.own[b] - own).norm() < tolerance * X.squaredNorm());
  }
}

}  // namespace

TEST_CASE("columns are carried by a noise as its covariance says") {
  check(NoiseModel{.d = 0.0, .phi = Eigen::VectorXd::Constant(1, 0.8), .sigma = 2.0});
  check(NoiseModel{.d = 0.3, .phi = {}, .sigma = 0.5});
  check(NoiseModel{.d = 0.8, .phi = Eigen::VectorXd::Constant(1, 0.2), .sigma = 1.5});
  check(noise::GaussMarkovNoise{.rows = 9.0, .white = 0.4, .sigma = 3.0});
}

TEST_CASE("runs and stretches have their rows in common, each once") {
  const std::vector<noise::Piece> pieces = noise::cut_runs(runs, cuts);
  REQUIRE(pieces.size() == 4);
  Index next = 0;
  for (const noise::Piece& piece : pieces) {
    CHECK(piece.first == next);
    next += piece.rows;
  }
  CHECK(next == rows);
  CHECK(pieces[2].stretch == 1);
  CHECK(pieces[2].run_first == 31);
}

}  // namespace carried_test
