// SPDX-License-Identifier: BSD-3-Clause
// Recursive least squares in its three forms against one solution of the whole batch.
#include "sepcal/states/recursive_least_squares.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <vector>

#include "draws.hpp"
#include "sepcal/detail/states/information_root.hpp"
#include "sepcal/detail/triangular_factor.hpp"

namespace recursive_least_squares_test {

using sepcal::CovarianceRecursion;
using sepcal::InformationRecursion;
using sepcal::InformationRoot;
using sepcal::test::Draws;

namespace {

constexpr int n = 4;  // parameters
constexpr int m = 3;  // outputs
using Parameters = Eigen::Vector<double, n>;
using Matrix = Eigen::Matrix<double, n, n>;

struct Sample {
  Eigen::Matrix<double, m, n> H;
  Eigen::Vector<double, m> y;
  Eigen::Matrix<double, m, m> W;
};

std::vector<Sample> draw_samples(int count, std::uint64_t seed) {
  Draws draws(seed);
  std::vector<Sample> samples;
  for (int k = 0; k < count; ++k) {
    const Eigen::MatrixXd root = draws.normal_matrix(m, m + 2);
    samples.push_back(
        {draws.normal_matrix(m, n), draws.normal_matrix(m, 1), root * root.transpose() / m});
  }
  return samples;
}

struct Batch {
  Eigen::VectorXd p;
  Eigen::MatrixXd covariance;
  double cost = 0.0;
};

/// QR of all whitened rows at once, of outputs that are not NaN.
Batch solve_batch(const std::vector<Sample>& samples) {
  std::vector<Eigen::VectorXd> rows;
  for (const Sample& sample : samples) {
    std::vector<int> there;
    for (int j = 0; j < m; ++j) {
      if (!std::isnan(sample.y[j])) there.push_back(j);
    }
    if (there.empty()) continue;
    const Eigen::MatrixXd W = sample.W(there, there);
    Eigen::MatrixXd row(there.size(), n + 1);
    row << sample.H(there, Eigen::all), sample.y(there);
    row = Eigen::LLT<Eigen::MatrixXd>(W).matrixL().solve(row).eval();
    for (Eigen::Index j = 0; j < row.rows(); ++j) rows.emplace_back(row.row(j));
  }
  Eigen::MatrixXd all(rows.size(), n + 1);
  for (std::size_t k = 0; k < rows.size(); ++k) all.row(static_cast<Eigen::Index>(k)) = rows[k];
  const Eigen::MatrixXd H = all.leftCols(n);
  const Eigen::VectorXd p = H.colPivHouseholderQr().solve(all.col(n));
  return {p, (H.transpose() * H).inverse(), 0.5 * (all.col(n) - H * p).squaredNorm()};
}

template <class Recursion>
double distance(const Recursion& recursion, const Batch& batch) {
  return std::max((recursion.solution() - batch.p).norm() / batch.p.norm(),
                  (recursion.covariance() - batch.covariance).norm() / batch.covariance.norm());
}

}  // namespace

TEST_CASE("both recursions and the root, after 12 vector samples with a full W, are the batch") {
  double worst = 0.0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    std::vector<Sample> samples = draw_samples(12, seed);
    if (seed == 3U) {
      samples[3].y[1] = std::nan("");
      samples[7].y.setConstant(std::nan(""));
    }
    // The first two samples are the start.
    const Batch start = solve_batch({samples.begin(), samples.begin() + 2});
    InformationRecursion<n> information(Parameters(start.p), Matrix(start.covariance.inverse()));
    CovarianceRecursion<n> covariance(Parameters(start.p), Matrix(start.covariance));
    InformationRoot<n> root;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const Sample& sample = samples[k];
      CHECK(root.absorb(sample.H, sample.y, sample.W));
      if (k < 2) continue;
      CHECK(information.absorb(sample.H, sample.y, sample.W));
      CHECK(covariance.absorb(sample.H, sample.y, sample.W));
    }
    const Batch batch = solve_batch(samples);
    for (const double error :
         {distance(information, batch), distance(covariance, batch), distance(root, batch)}) {
      worst = std::max(worst, error);
      CHECK(error < 1e-12);
    }
    CHECK(root.cost() == doctest::Approx(batch.cost).epsilon(1e-12));
    CHECK(root.count() == (seed == 3U ? 32 : 36));
  }
  MESSAGE("recursions from the batch: " << worst);
}

TEST_CASE("a batch's triangular factor goes on as a stream, without an inversion") {
  const std::vector<Sample> samples = draw_samples(20, 4);
  sepcal::TriangularFactor factor(n + 1);
  for (std::size_t k = 0; k < 8; ++k) {
    Eigen::MatrixXd rows(m, n + 1);
    rows << samples[k].H, samples[k].y;
    rows = Eigen::LLT<Eigen::MatrixXd>(samples[k].W).matrixL().solve(rows).eval();
    factor.absorb(rows);
  }
  InformationRoot<n> root{InformationRoot<n>::Triangle(factor.matrix())};
  for (std::size_t k = 8; k < samples.size(); ++k) {
    root.absorb(samples[k].H, samples[k].y, samples[k].W);
  }
  CHECK(distance(root, solve_batch(samples)) < 1e-12);
}

TEST_CASE("the root says what is not determined, and solves the rest") {
  InformationRoot<n> root;
  CHECK_FALSE(root.determined());
  CHECK(root.solution() == Parameters::Zero());
  for (Sample& sample : draw_samples(5, 5)) {
    sample.H.col(2) = 2.0 * sample.H.col(1);
    root.absorb(sample.H, sample.y, sample.W);
  }
  CHECK_FALSE(root.determined());
  CHECK(root.solution()[2] == 0.0);
  CHECK(root.solution().allFinite());
}

TEST_CASE("of rows whose columns are nearly alike the root keeps twice the digits") {
  Draws draws(6);
  const Parameters truth(1.0, 2.0, 3.0, 4.0);
  const Parameters start = Parameters::Zero();
  CovarianceRecursion<n> covariance(start, Matrix(1e12 * Matrix::Identity()));
  InformationRoot<n> root;
  using One = Eigen::Matrix<double, 1, 1>;
  for (int k = 0; k < 40; ++k) {
    Eigen::Matrix<double, 1, n> H = draws.normal_matrix(1, n);
    H[3] = H[0] + 1e-7 * H[3];
    const Eigen::Vector<double, 1> y = H * truth;
    covariance.absorb(H, y, One(1.0));
    root.absorb(H, y, One(1.0));
  }
  CHECK((root.solution() - truth).norm() < 1e-6);
  CHECK_FALSE((covariance.solution() - truth).norm() < 1e-4);
}

TEST_CASE("what is unfit changes nothing") {
  const std::vector<Sample> samples = draw_samples(3, 7);
  InformationRoot<n> root;
  InformationRecursion<n> information(Parameters::Zero(), Matrix::Identity());
  CovarianceRecursion<n> covariance(Parameters::Zero(), Matrix::Identity());
  const auto refused = [&](const Sample& bad) {
    return !root.absorb(bad.H, bad.y, bad.W) && !information.absorb(bad.H, bad.y, bad.W) &&
           !covariance.absorb(bad.H, bad.y, bad.W);
  };
  Sample bad = samples[0];
  bad.H(1, 1) = std::nan("");
  CHECK(refused(bad));
  bad = samples[0];
  bad.y[2] = HUGE_VAL;
  CHECK(refused(bad));
  bad = samples[0];
  bad.W(0, 0) = -1e3;
  CHECK(refused(bad));
  CHECK(root.matrix().isZero(0.0));
  CHECK(information.solution() == Parameters::Zero());
  CHECK(covariance.covariance() == Matrix::Identity());
  bad.W(0, 0) = -0.1;  // no variance, though H H' + W is one
  CHECK(refused(bad));
}

TEST_CASE("a covariance keeps its digits from a start a million times as wide") {
  const std::vector<Sample> samples = draw_samples(12, 4);
  const double wide = 1e6;
  CovarianceRecursion<n> covariance(Parameters::Zero(), Matrix(wide * wide * Matrix::Identity()));
  for (const Sample& sample : samples) CHECK(covariance.absorb(sample.H, sample.y, sample.W));
  const Batch batch = solve_batch(samples);  // the start is worth 1e-12 of it
  const Eigen::VectorXd sd = batch.covariance.diagonal().cwiseSqrt();
  CHECK(((covariance.solution() - batch.p).array().abs() <= 1e-8 * sd.array()).all());
  CHECK((covariance.covariance() - batch.covariance).norm() < 1e-8 * batch.covariance.norm());
}

}  // namespace recursive_least_squares_test
