// SPDX-License-Identifier: BSD-3-Clause
// Noise of inputs: the likelihood ratio against one with the dense covariance of exact Gauss-Markov
// sizes, and how often a constant error of an input is taken for one where it wanders.
#include "diagnosis/input_drift.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/projection.hpp"
#include "linearisations.hpp"
#include "numerics/tails.hpp"
#include "simulated_records.hpp"

namespace input_drift_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace sepcal;
using namespace sepcal::test;

namespace {

constexpr Index rows = 150;
constexpr double seconds = 100.0;

/// Two outputs that an error of the heading turns into each other on a circle flown thrice.
struct Turning {
  diagnosis::RowLayout layout = make_layout({{"", rows}}, {1.0, 1.0});
  MatrixXd slopes = MatrixXd(2 * rows, 1);
  MatrixXd tangent = MatrixXd::Zero(2 * rows, 2);

  Turning() {
    const VectorXd heading = VectorXd::LinSpaced(rows, 0.0, 18.0);
    slopes << heading.array().sin().matrix(), heading.array().cos().matrix();
    tangent.col(0).head(rows).setOnes();
    tangent.col(1).tail(rows).setOnes();
  }

  diagnosis::LinearisedFit fit(const VectorXd& noise) const {
    diagnosis::LinearisedFit fit = fit_to(layout, tangent, noise);
    fit.input_drift = slopes;
    for (Index i = 0; i < rows; ++i) {
      fit.times.push_back(seconds * static_cast<double>(i) / static_cast<double>(rows - 1));
    }
    return fit;
  }

  /// White noise beside an error of the heading that wanders, as large, within `time` [s].
  VectorXd draw(Draws& draws, double time) const {
    const double phi = std::exp(-seconds / static_cast<double>(rows - 1) / time);
    VectorXd error(rows);
    error[0] = draws.normal();
    for (Index i = 1; i < rows; ++i) {
      error[i] = phi * error[i - 1] + std::sqrt(1.0 - phi * phi) * draws.normal();
    }
    return draws.normal_matrix(2 * rows, 1) + 1.5 * slopes.cwiseProduct(error.replicate(2, 1));
  }

  MatrixXd constant() const {
    return diagnosis::orthonormal_basis(
        diagnosis::remove_span(diagnosis::orthonormal_basis(tangent), slopes));
  }
};

/// -2 ln L of columns in white noise beside exact Gauss-Markov sizes, at its least over a grid.
double dense_likelihood(const Turning& flight, const MatrixXd& columns, const VectorXd& z) {
  const auto n = static_cast<double>(z.size());
  double least = n * std::log((z - columns * least_squares(columns, z)).squaredNorm());
  for (double time = 2.0; time < 210.0; time *= 1.5) {
    for (double variance = 0.01; variance < 300.0; variance *= 1.6) {
      MatrixXd V = MatrixXd::Identity(z.size(), z.size());
      for (Index a = 0; a < V.rows(); ++a) {
        for (Index b = 0; b < V.cols(); ++b) {
          const auto apart = static_cast<double>(std::abs(a % rows - b % rows));
          V(a, b) += variance * flight.slopes(a, 0) * flight.slopes(b, 0) *
                     std::exp(-apart * seconds / static_cast<double>(rows - 1) / time);
        }
      }
      const Eigen::LLT<MatrixXd> factor(V);
      const MatrixXd L = factor.matrixL();
      MatrixXd white(z.size(), columns.cols() + 1);
      white << columns, z;
      L.triangularView<Eigen::Lower>().solveInPlace(white);
      const VectorXd y = white.rightCols<1>();
      const MatrixXd X = white.leftCols(columns.cols());
      least = std::min(least, n * std::log((y - X * least_squares(X, y)).squaredNorm()) +
                                  2.0 * L.diagonal().array().log().sum());
    }
  }
  return least;
}

}  // namespace

TEST_CASE("the ratio is that of the dense covariance") {
  const Turning flight;
  for (const double time : {15.0, 60.0}) {
    Draws draws(3);
    VectorXd z = flight.draw(draws, time) + 2.0 * flight.slopes;
    const diagnosis::LinearisedFit fit = flight.fit(z);
    const diagnosis::InputDrift inputs{diagnosis::TangentBasis(fit)};
    const MatrixXd added = flight.constant();
    MatrixXd columns(2 * rows, 3);
    columns << flight.tangent, added;
    const double expected = dense_likelihood(flight, flight.tangent, fit.residual) -
                            dense_likelihood(flight, columns, fit.residual);
    CAPTURE(time);
    CHECK(expected > 1.0);
    CHECK(inputs.compare(added).ratio() == Approx(expected).epsilon(0.15));
  }
}

TEST_CASE("in white noise the ratio of a driven column is nearly least squares'") {
  const Turning flight;
  Draws draws(8);
  MatrixXd G = draws.normal_matrix(2 * rows, 1);
  const diagnosis::LinearisedFit fit =
      flight.fit(0.5 * G + VectorXd(draws.normal_matrix(2 * rows, 1)));
  const MatrixXd basis = diagnosis::orthonormal_basis(flight.tangent);
  const MatrixXd added = diagnosis::orthonormal_basis(diagnosis::remove_span(basis, G));
  const VectorXd left = fit.residual - added * (added.transpose() * fit.residual);
  const double expected = 2.0 * rows * std::log(fit.residual.squaredNorm() / left.squaredNorm());
  CHECK(diagnosis::InputDrift(diagnosis::TangentBasis(fit)).compare(added).ratio() ==
        Approx(expected).epsilon(0.03));
}

TEST_CASE("a heading that wanders is seldom taken for one that is off") {
  constexpr int flights = 100;
  constexpr int most = 14;  // of 100 at 5 %, and by chance once in 5,000
  const Turning flight;
  const MatrixXd added = flight.constant();
  for (const double time : {10.0, 30.0, 100.0}) {
    int found = 0;
    int found_in_white = 0;
    for (std::uint64_t seed = 1; seed <= flights; ++seed) {
      Draws draws(seed);
      const diagnosis::LinearisedFit fit = flight.fit(flight.draw(draws, time));
      const diagnosis::InputDrift inputs{diagnosis::TangentBasis(fit)};
      std::vector<double> ratios =
          inputs.draw_ratios(added, diagnosis::InputDrift::Noise::without, 60, seed);
      std::ranges::sort(ratios);
      const double factor = ratios.empty()
                                ? 1.0
                                : std::max({1.0, ratios[30] / numerics::chi_squared_point(0.5, 1),
                                            ratios[54] / numerics::chi_squared_point(0.1, 1)});
      const double point = numerics::chi_squared_point(0.05, 1);
      found += inputs.compare(added).ratio() / factor > point;
      const double square = added.col(0).dot(fit.residual);
      found_in_white += square * square > point * fit.residual.squaredNorm() / (2.0 * rows);
    }
    CAPTURE(time);
    CHECK(found <= most);
    CHECK(found_in_white > 50);
  }
}

TEST_CASE("without corrections that wander there is none") {
  const Turning flight;
  Draws draws(1);
  diagnosis::LinearisedFit fit = flight.fit(draws.normal_matrix(2 * rows, 1));
  fit.input_drift.resize(2 * rows, 0);
  CHECK(diagnosis::InputDrift(diagnosis::TangentBasis(fit)).is_empty());
}

}  // namespace input_drift_test
