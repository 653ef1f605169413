// SPDX-License-Identifier: BSD-3-Clause
// Random numbers for tests.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

namespace sepcal::test {

/// Seeded numbers that are the same with every standard library.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : generator_(seed) {}

  double uniform(double lower, double upper) {
    return lower + (upper - lower) * (static_cast<double>(generator_() >> 11U) + 0.5) * 0x1p-53;
  }
  double normal() {  // Box & Muller
    const double radius = std::sqrt(-2.0 * std::log(uniform(0, 1)));
    return radius * std::cos(uniform(0, 2.0 * std::numbers::pi));
  }
  Eigen::MatrixXd normal_matrix(Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [this] { return normal(); });
  }
  std::vector<double> uniform_column(std::size_t rows, double lower, double upper) {
    std::vector<double> column(rows);
    for (double& x : column) x = uniform(lower, upper);
    return column;
  }

 private:
  std::mt19937_64 generator_;
};

}  // namespace sepcal::test
