// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/nearest_points.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace nearest_points_test {

using namespace sepcal;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {

/// By looking at every other point.
std::vector<Index> look_around(const MatrixXd& points, Index s, Index count) {
  std::vector<Index> others(static_cast<std::size_t>(points.cols()));
  std::iota(others.begin(), others.end(), Index{0});
  std::erase(others, s);
  std::ranges::stable_sort(others, {},
                           [&](Index i) { return (points.col(i) - points.col(s)).squaredNorm(); });
  others.resize(static_cast<std::size_t>(count));
  return others;
}

}  // namespace

TEST_CASE("the tree finds the same neighbours as a look at every point") {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::uniform_int_distribution<int> coarse(0, 3);
  for (const Index n : {1, 2, 5, 11}) {
    for (const Index S : {2, 9, 40, 300}) {
      for (const bool many_alike : {false, true}) {
        CAPTURE(n);
        CAPTURE(S);
        MatrixXd points(n, S);
        for (double& x : points.reshaped()) {
          x = many_alike ? coarse(generator) : uniform(generator);
        }
        const Index count = std::min<Index>(4 * n, S - 1);
        numerics::NearestPoints tree(points);
        std::vector<Index> found;
        for (Index s = 0; s < S; ++s) {
          tree.find(s, count, found);
          CHECK(found == look_around(points, s, count));
        }
      }
    }
  }
}

TEST_CASE("the nearest of another label is the first such neighbour") {
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  MatrixXd points(3, 200);
  for (double& x : points.reshaped()) x = uniform(generator);
  std::vector<Index> labels;
  for (Index s = 0; s < points.cols(); ++s) labels.push_back(points(0, s) > 0.2 ? 1 : 0);
  const numerics::NearestPoints tree(points);
  for (Index s = 0; s < points.cols(); ++s) {
    const auto all = look_around(points, s, points.cols() - 1);
    const auto expected = std::ranges::find_if(all, [&](Index other) {
      return labels[static_cast<std::size_t>(other)] != labels[static_cast<std::size_t>(s)];
    });
    CHECK(tree.find_other(s, labels, 1e9).second == *expected);
  }
  CHECK(tree.find_other(0, std::vector<Index>(200, 1), 1e9).second == -1);
  CHECK(tree.find_other(0, labels, 1e-9).second == -1);
}

TEST_CASE("a point by itself has no neighbour") {
  std::vector<Index> found{7};
  numerics::NearestPoints(MatrixXd::Zero(2, 1)).find(0, 0, found);
  CHECK(found.empty());
}

}  // namespace nearest_points_test
