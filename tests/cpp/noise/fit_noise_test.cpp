// SPDX-License-Identifier: BSD-3-Clause
// R, given or estimated (Eqs. 24-26), and the covariance that goes with it.
#include <doctest/doctest.h>

#include <cmath>

#include "dense_reference.hpp"
#include "numerics/decompositions.hpp"
#include "sepcal/fit.hpp"
#include "simulated_records.hpp"
#include "small_models.hpp"

namespace fit_noise_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::FitStatus;
using sepcal::test::Simulated;

namespace {

constexpr std::size_t rows = 400;

FitOptions quick() {
  FitOptions options;
  options.samples = 60;
  return options;
}

VectorXd noise_of(const Fit& result) {
  VectorXd noise(static_cast<Index>(result.noise.size()));
  for (Index j = 0; j < noise.size(); ++j)
    noise[j] = result.noise[static_cast<std::size_t>(j)].value;
  return noise;
}

/// Whitened [A | D | r] at the solution.
MatrixXd dense_at(const Simulated& simulated, const Fit& result, const VectorXd& noise) {
  return sepcal::test::whiten(
      sepcal::test::dense_rows(*simulated.model, simulated.record, result.xi1(), result.xi2()),
      noise);
}

MatrixXd inverse_square(const MatrixXd& whitened) {
  const MatrixXd J = whitened.leftCols(whitened.cols() - 1);
  return (J.transpose() * J).inverse();
}

double relative_error(const MatrixXd& a, const MatrixXd& b) {
  const VectorXd sd = b.diagonal().cwiseSqrt();
  return (sd.cwiseInverse().asDiagonal() * (a - b) * sd.cwiseInverse().asDiagonal())
      .cwiseAbs()
      .maxCoeff();
}

}  // namespace

TEST_CASE("R-hat is the mean squared residual at the end, by output; rmse is its root") {
  for (const Simulated& simulated : sepcal::test::simulate_all(rows)) {
    CAPTURE(simulated.name);
    const Fit result = sepcal::fit(*simulated.model, simulated.record, quick());
    CHECK(result.status == FitStatus::converged);
    const VectorXd r =
        dense_at(simulated, result, VectorXd::Ones(static_cast<Index>(result.noise.size())))
            .rightCols<1>();
    for (std::size_t j = 0; j < result.noise.size(); ++j) {
      const auto first = static_cast<Index>(j * rows);
      const double expected = std::sqrt(r.segment(first, rows).squaredNorm() / rows);
      CHECK(result.noise[j].name == simulated.model->tables().outputs[j].name);
      CHECK(result.noise[j].value == Approx(expected).epsilon(1e-9));
      CHECK(result.rmse[j].value == Approx(expected).epsilon(1e-9));
    }
    // At that R the parameters are at their minimum, too.
    const MatrixXd whitened = dense_at(simulated, result, noise_of(result));
    const MatrixXd inverse = inverse_square(whitened);
    const VectorXd step =
        inverse * (whitened.leftCols(inverse.cols()).transpose() * whitened.rightCols<1>());
    CHECK(step.cwiseQuotient(inverse.diagonal().cwiseSqrt()).cwiseAbs().maxCoeff() < 1e-6);
  }
}

TEST_CASE("with R estimated the white covariance is (J' R^-1 J)^-1 times M / (M - n)") {
  for (const Simulated& simulated : sepcal::test::simulate_all(rows)) {
    CAPTURE(simulated.name);
    const Fit result = sepcal::fit(*simulated.model, simulated.record, quick());
    const MatrixXd inverse = inverse_square(dense_at(simulated, result, noise_of(result)));
    const double M = static_cast<double>(rows * result.noise.size());
    const auto n = static_cast<double>(inverse.cols());
    CHECK(relative_error(result.covariance_white, inverse * (M / (M - n))) < 1e-6);
    const VectorXd white = result.covariance_white.diagonal().cwiseSqrt();
    const VectorXd sd = result.covariance.diagonal().cwiseSqrt();
    for (Index k = 0; k < sd.size(); ++k) {
      const sepcal::Parameter& parameter = result.parameters[static_cast<std::size_t>(k)];
      CHECK(parameter.standard_error_white == Approx(white[k]));
      CHECK(parameter.standard_error == Approx(sd[k]));
      CHECK(result.correlation(k, k) == 1.0);
      CHECK(result.correlation(k, 0) == Approx(result.covariance(k, 0) / (sd[k] * sd[0])));
    }
    CHECK(result.covariance == result.covariance.transpose());
    CHECK(result.covariance_white == result.covariance_white.transpose());
  }
}

TEST_CASE("with R given nothing is scaled, R stays, and the cost is Eq. 6") {
  for (const Simulated& simulated : sepcal::test::simulate_all(rows)) {
    CAPTURE(simulated.name);
    const auto& outputs = simulated.model->tables().outputs;
    FitOptions options = quick();
    VectorXd given(static_cast<Index>(outputs.size()));
    for (std::size_t j = 0; j < outputs.size(); ++j) {
      given[static_cast<Index>(j)] = options.noise[outputs[j].name] =
          0.05 * static_cast<double>(1 + j * j);
    }
    const Fit result = sepcal::fit(*simulated.model, simulated.record, options);
    CHECK(result.status == FitStatus::converged);
    CHECK(result.noise_iterations == 0);
    CHECK(noise_of(result) == given);
    const MatrixXd whitened = dense_at(simulated, result, given);
    CHECK(relative_error(result.covariance_white, inverse_square(whitened)) < 1e-6);
    const double J = 0.5 * whitened.rightCols<1>().squaredNorm() +
                     static_cast<double>(rows) * given.array().log().sum();
    CHECK(result.cost == Approx(J).epsilon(1e-10));
  }
}

TEST_CASE("weights matter: R estimated is not R = I") {
  const Simulated flight = sepcal::test::simulate_five_hole(rows, 3.0);
  FitOptions options = quick();
  const Fit estimated = sepcal::fit(*flight.model, flight.record, options);
  options.noise = {{"vn", 1}, {"ve", 1}, {"vd", 1}};
  const Fit equal = sepcal::fit(*flight.model, flight.record, options);
  CHECK(std::abs(estimated["w_n"].value - equal["w_n"].value) > 1e-4);
}

TEST_CASE("the paper's tolerance of 0.05 stops earlier than the default, close to the same place") {
  const Simulated flight = sepcal::test::simulate_five_hole(rows, 3.0);
  FitOptions options = quick();
  const Fit tight = sepcal::fit(*flight.model, flight.record, options);
  options.noise_tolerance = 0.05;
  const Fit loose = sepcal::fit(*flight.model, flight.record, options);
  CHECK(loose.status == FitStatus::converged);
  CHECK(loose.noise_iterations < tight.noise_iterations);
  for (std::size_t k = 0; k < 10; ++k) {
    CHECK(std::abs(loose.parameters[k].value - tight.parameters[k].value) <
          0.3 * tight.parameters[k].standard_error);
  }
}

TEST_CASE("an alternation that is cut short is a status that says so, not an exception") {
  const Simulated flight = sepcal::test::simulate_five_hole(rows, 3.0);
  FitOptions options = quick();
  options.noise_iterations = 1;
  const Fit result = sepcal::fit(*flight.model, flight.record, options);
  CHECK(result.status == FitStatus::not_converged);
  CHECK(result.message.find("R did not settle within 1 iterations") != std::string::npos);
  CHECK(result.values().allFinite());
}

TEST_CASE("a minimisation that is cut short on a hard start is a status, not an exception") {
  // A fast wave whose frequency is far off at the start: no step from there is near the minimum.
  sepcal::test::Draws draws(0);
  sepcal::Record record;
  record.add("eta", draws.uniform_column(60, 0, 60)).add("z", draws.uniform_column(60, -1, 1));
  FitOptions options;
  options.noise = {{"z", 0.01}};
  options.samples = 0;
  options.iterations = 1;
  options.bounds = {{"b", {-0.9, 0.9}}, {"c", {-3, 3}}};
  const Fit result = sepcal::fit(sepcal::ScalarExample2{}, record, options);
  CHECK(result.status == FitStatus::not_converged);
  CHECK(result.message.find("the minimisation did not converge") != std::string::npos);
  CHECK(result.values().allFinite());
}

TEST_CASE("of residuals below the floor of the noise the standard errors are the residuals' own") {
  // z = s u + c with residuals of 4e-14, exact in binary: s^2 and the errors follow by hand.
  const double e = std::ldexp(1.0, -45);
  sepcal::Record record;
  record.add("u", {0, 1, 2, 3}).add("z", {1 + e, 2 - e, 3 - e, 4 + e});
  const Fit result = sepcal::fit(sepcal::test::Line{}, record, quick());
  CHECK(result.status == FitStatus::converged);
  CHECK(result.noise[0].value > 10.0 * e);  // it stands at its floor
  const double variance = 4 * e * e / 2;    // SSE / (M - n): the pattern is orthogonal to 1 and u
  CHECK(result["s"].standard_error_white == Approx(std::sqrt(variance / 5)).epsilon(1e-2));
  CHECK(result["c"].standard_error_white == Approx(std::sqrt(0.7 * variance)).epsilon(1e-2));
}

TEST_CASE("progress of both stages lies within [0, 1]") {
  const Simulated wave = sepcal::test::simulate_scalar_1(rows);
  FitOptions options = quick();
  bool heard_one = false;
  bool heard_two = false;
  options.progress = [&](std::string_view task, double fraction) {
    (task == "stage one" ? heard_one : heard_two) = true;
    CHECK(fraction >= 0.0);
    CHECK(fraction <= 1.0);
  };
  (void)sepcal::fit(*wave.model, wave.record, options);
  CHECK(heard_one);
  CHECK(heard_two);
}

}  // namespace fit_noise_test
