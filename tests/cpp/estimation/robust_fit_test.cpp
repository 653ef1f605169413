// SPDX-License-Identifier: BSD-3-Clause
// Fits that forgive outliers: what these do to the noise, and losses so wide that they are squares.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "dense_reference.hpp"
#include "flights_with_outliers.hpp"
#include "numerics/decompositions.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/fit.hpp"
#include "simulated_records.hpp"

namespace robust_fit_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::Loss;
using sepcal::Record;
using sepcal::test::simulate_with_outliers;

namespace {

/// The farthest estimate of `other`, in standard errors of `fit`.
double distance(const Fit& fit, const Fit& other) {
  double largest = 0.0;
  for (const sepcal::Parameter& parameter : fit.parameters) {
    const double off = std::abs(parameter.value - other[parameter.name].value);
    largest = std::max(largest, off / parameter.standard_error);
  }
  return largest;
}

/// J over the rows, 1 / noise times [A | D] by differences, and r likewise.
struct Dense {
  MatrixXd J;
  VectorXd r;
};
Dense whitened(const sepcal::test::Simulated& flight, const Fit& fit, const VectorXd& noise) {
  const MatrixXd rows = sepcal::test::whiten(
      sepcal::test::dense_rows(*flight.model, flight.record, fit.xi1(), fit.xi2()), noise);
  return {rows.leftCols(rows.cols() - 1), rows.rightCols<1>()};
}

/// Errors by the sandwich H^-1 (sum psi^2 J'J) H^-1 M / (M - n), H = sum psi' J'J, for a loss so
/// wide that psi is the residual: each white row by its own square.
VectorXd own_square_errors(const Dense& dense) {
  const MatrixXd inverse = (dense.J.transpose() * dense.J).inverse();
  const MatrixXd middle = dense.J.transpose() * dense.r.cwiseAbs2().asDiagonal() * dense.J;
  const auto count = static_cast<double>(dense.J.rows());
  const double ratio = count / (count - static_cast<double>(dense.J.cols()));
  return (ratio * (inverse * middle * inverse).diagonal()).cwiseSqrt();
}

}  // namespace

TEST_CASE("outliers raise the noise of the plain fit, and its errors, but not the robust one's") {
  const Record record = simulate_with_outliers(0, false);
  const Fit robust = sepcal::fit(sepcal::ScalarExample1{}, record, {.loss = Loss::cauchy});
  const Fit plain = sepcal::fit(sepcal::ScalarExample1{}, record, {});
  CHECK(robust.second_stage == sepcal::SecondStage::joint);
  CHECK(robust.noise[0].value < 0.13);
  CHECK(plain.noise[0].value > 0.5);
  CHECK(robust["c"].standard_error < 0.3 * plain["c"].standard_error);
}

TEST_CASE("a Huber loss wider than every residual is squares, its errors each row's own") {
  const auto flight = sepcal::test::simulate_five_hole(300);
  FitOptions options;
  options.samples = 50;
  options.second_stage = sepcal::SecondStage::joint;
  options.coloured_errors = false;
  const Fit plain = sepcal::fit(*flight.model, flight.record, options);
  options.loss = Loss::huber;
  options.loss_width = 30.0;  // with it R-hat's truncation at k sigma keeps every row, too
  const Fit wide = sepcal::fit(*flight.model, flight.record, options);
  CHECK(distance(plain, wide) < 1e-9);
  const VectorXd noise =
      Eigen::Vector3d(wide.noise[0].value, wide.noise[1].value, wide.noise[2].value);
  for (std::size_t j = 0; j < 3; ++j) {
    CHECK(wide.noise[j].value == doctest::Approx(plain.noise[j].value).epsilon(1e-10));
  }
  const VectorXd expected = own_square_errors(whitened(flight, wide, noise));
  for (std::size_t k = 0; k < wide.parameters.size(); ++k) {
    CAPTURE(wide.parameters[k].name);
    CHECK(wide.parameters[k].standard_error ==
          doctest::Approx(expected[static_cast<Index>(k)]).epsilon(1e-7));
  }
}

TEST_CASE("a Cauchy loss of width w differs from squares by 1 / w^2 where the noise is given") {
  // Without it R-hat is Huber's scale at 1.345 whatever the width: outputs weigh otherwise.
  const auto flight = sepcal::test::simulate_five_hole(300);
  const VectorXd noise = Eigen::Vector3d(0.1, 0.2, 0.3);
  FitOptions options;
  options.samples = 50;
  options.second_stage = sepcal::SecondStage::joint;
  options.coloured_errors = false;
  for (std::size_t j = 0; j < 3; ++j) {
    options.noise[flight.model->tables().outputs[j].name] = noise[static_cast<Index>(j)];
  }
  const Fit plain = sepcal::fit(*flight.model, flight.record, options);
  options.loss = Loss::cauchy;
  options.loss_width = 10.0;
  const double at_10 = distance(plain, sepcal::fit(*flight.model, flight.record, options));
  options.loss_width = 100.0;
  const double at_100 = distance(plain, sepcal::fit(*flight.model, flight.record, options));
  CHECK(at_10 / at_100 == doctest::Approx(100.0).epsilon(0.1));
  options.loss_width = 1e4;
  const Fit wide = sepcal::fit(*flight.model, flight.record, options);
  // Of first order the distance at w is 1e-6 times that at 10; the last digits are 1e-10.
  CHECK(distance(plain, wide) < 1.2e-6 * at_10 + 1e-9);
  const VectorXd expected = own_square_errors(whitened(flight, wide, noise));
  for (std::size_t k = 0; k < wide.parameters.size(); ++k) {
    CAPTURE(wide.parameters[k].name);
    CHECK(wide.parameters[k].standard_error ==
          doctest::Approx(expected[static_cast<Index>(k)]).epsilon(1e-6));
  }
}

}  // namespace robust_fit_test
