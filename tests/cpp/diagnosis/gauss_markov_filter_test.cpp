// SPDX-License-Identifier: BSD-3-Clause
// The filter of noise that wanders against the covariance that it stands for, written out.
#include "diagnosis/gauss_markov_filter.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <tuple>
#include <vector>

namespace gauss_markov_filter_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::diagnosis::GaussMarkovFilter;
using sepcal::diagnosis::GaussMarkovState;

struct Case {
  std::vector<double> times = {};
  VectorXd white = {};
  std::vector<VectorXd> slopes = {};
  std::vector<GaussMarkovState> states = {};

  Index rows() const { return std::ssize(times); }

  double slope(const GaussMarkovState& state, Index output, Index row) const {
    if (state.slopes != nullptr) return (*state.slopes)[output * rows() + row];
    return output == state.output ? 1.0 : 0.0;
  }

  MatrixXd covariance() const {
    const Index count = white.size() * rows();
    MatrixXd all = MatrixXd::Zero(count, count);
    for (Index a = 0; a < count; ++a) {
      for (Index b = 0; b < count; ++b) {
        const Index s = a % rows();
        const Index t = b % rows();
        for (const GaussMarkovState& state : states) {
          const double apart = state.rows > 0.0 ? std::abs(static_cast<double>(s - t)) / state.rows
                                                : std::abs(times[static_cast<std::size_t>(s)] -
                                                           times[static_cast<std::size_t>(t)]) /
                                                      state.time;
          all(a, b) += state.variance * std::exp(-apart) * slope(state, a / rows(), s) *
                       slope(state, b / rows(), t);
        }
      }
      all(a, a) += white[a / rows()];
    }
    return all;
  }
};

/// `slow` errors with slopes of any kind, and one of each output over a few rows.
Case make_case(int slow, Index rows, Index outputs) {
  Case made{.white = VectorXd::LinSpaced(outputs, 0.5, 1.5)};
  double time = 100.0;
  for (Index t = 0; t < rows; ++t) made.times.push_back(time += t % 7 == 0 ? 0.9 : 0.1);
  made.slopes.reserve(static_cast<std::size_t>(slow));
  for (int k = 0; k < slow; ++k) {
    VectorXd slopes(outputs * rows);
    for (Index i = 0; i < slopes.size(); ++i)
      slopes[i] = std::sin(0.3 * (k + 1.0) * static_cast<double>(i + 1));
    if (outputs > 1 && k % 2 == 0) slopes.head(rows).setZero();
    made.slopes.push_back(slopes);
    made.states.push_back(
        {.variance = 1.0 + k, .time = 5.0 * (1 + k / 2), .slopes = &made.slopes.back()});
  }
  for (Index j = 0; j < outputs; ++j) {
    made.states.push_back({.variance = 0.7, .rows = 3.0, .output = j});
  }
  return made;
}

TEST_CASE("a Gauss-Markov filter is the inverse of its covariance") {
  for (const auto& [slow, rows, outputs] :
       {std::tuple{0, Index{30}, Index{1}}, {1, 40, 1}, {4, 35, 2}, {11, 25, 3}}) {
    const Case made = make_case(slow, rows, outputs);
    const MatrixXd covariance = made.covariance();
    const GaussMarkovFilter filter(made.states, made.white, made.times);
    const Eigen::LLT<MatrixXd> factor(covariance);
    const MatrixXd L = factor.matrixL();
    CHECK(filter.log_determinant() ==
          Approx(2.0 * L.diagonal().array().log().sum()).epsilon(1e-12));
    CAPTURE(slow);
    for (const Index columns : {Index{1}, Index{8}, Index{13}}) {
      MatrixXd X(outputs * rows, columns);
      for (Index i = 0; i < X.size(); ++i) X.data()[i] = std::cos(0.7 * static_cast<double>(i));
      const MatrixXd white = filter.whiten(X);
      const MatrixXd wanted = X.transpose() * factor.solve(X);
      CHECK((white.transpose() * white - wanted).norm() < 1e-11 * wanted.norm());
    }
  }
}

TEST_CASE("of white noise alone it divides by the standard deviation") {
  const GaussMarkovFilter filter({}, VectorXd::Constant(1, 4.0), {0.0, 1.0, 2.0});
  const VectorXd column = Eigen::Vector3d(2.0, -4.0, 6.0);
  CHECK(filter.whiten(column).isApprox(0.5 * column));
  CHECK(filter.log_determinant() == Approx(3.0 * std::log(4.0)));
}

}  // namespace gauss_markov_filter_test
