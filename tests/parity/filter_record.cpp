// SPDX-License-Identifier: BSD-3-Clause
// Filters and smooths a record of a time-varying linear system, for other programs to compare with:
//   filter_record square-root|joseph < RECORD
// RECORD: numbers between white space: the number of samples; x0, P0; then, a sample: Phi, shift of
// x, Gamma, Q_d, C, shift of y, R, y (nan where missing), matrices row by row. Prints, a sample:
// x(k|k), P(k|k), x(k+1|k), P(k+1|k), x(k|N), P(k|N), w(k|N), Q(k|N), -ln p(y(k)).
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <numbers>
#include <string>
#include <vector>

#include "sepcal/detail/states/joseph_form.hpp"
#include "sepcal/states/filter.hpp"
#include "sepcal/states/smoother.hpp"

namespace {

constexpr int n = 3;
constexpr int n_w = 2;
constexpr int m = 2;
using Stage = sepcal::Stage<n, n_w>;
using Smoothed = sepcal::Smoothed<n, n_w>;

template <int R, int C = 1>
Eigen::Matrix<double, R, C> read() {
  Eigen::Matrix<double, R, C> matrix;
  std::string word;
  for (int i = 0; i < R; ++i) {
    for (int j = 0; j < C; ++j) {
      std::cin >> word;
      matrix(i, j) = std::strtod(word.c_str(), nullptr);  // nan too, which >> does not read
    }
  }
  return matrix;
}

template <class Derived>
void print(const Eigen::MatrixBase<Derived>& matrix) {
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) std::printf("%.17g ", matrix(i, j));
  }
}

template <class Form>
void filter_record() {
  std::size_t count = 0;
  std::cin >> count;
  const Eigen::Vector3d x0 = read<n>();
  sepcal::Filter<n, Form> filter(x0, read<n, n>());
  std::vector<Stage> pass(count);
  std::vector<sepcal::Estimate<n>> predicted(count);
  std::vector<double> costs(count);
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Matrix3d Phi = read<n, n>();
    const Eigen::Vector3d shift = read<n>();
    const Eigen::Matrix<double, n, n_w> Gamma = read<n, n_w>();
    const sepcal::LinearDynamics<n, n_w> dynamics{Phi, Gamma, read<n_w, n_w>()};
    const sepcal::LinearOutputs<m, n> outputs{read<m, n>()};
    const Eigen::Vector2d offset = read<m>();
    const Eigen::Matrix2d R = read<m, m>();
    const auto innovation = filter.update(read<m>(), outputs.at(filter.x(), offset), R);
    costs[k] = innovation.cost() + 0.5 * innovation.count * std::log(2.0 * std::numbers::pi);
    pass[k] = {filter.estimate(), dynamics.from(filter.x(), shift)};
    filter.predict(pass[k].next);
    predicted[k] = filter.estimate();
  }
  std::vector<Smoothed> smoothed(count);
  sepcal::smooth(std::span<const Stage>(pass), std::span<Smoothed>(smoothed));
  for (std::size_t k = 0; k < count; ++k) {
    print(pass[k].filtered.x);
    print(pass[k].filtered.covariance());
    print(predicted[k].x);
    print(predicted[k].covariance());
    print(smoothed[k].x);
    print(smoothed[k].P);
    print(smoothed[k].w);
    print(smoothed[k].Q);
    std::printf("%.17g\n", costs[k]);
  }
}

}  // namespace

int main(int count, char** arguments) {
  const std::string form = count == 2 ? arguments[1] : "";
  if (form == "square-root") {
    filter_record<sepcal::SquareRootForm<n>>();
  } else if (form == "joseph") {
    filter_record<sepcal::JosephForm<n>>();
  } else {
    std::cerr << "usage: filter_record square-root|joseph < RECORD\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
