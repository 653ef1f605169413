// SPDX-License-Identifier: BSD-3-Clause
// Bounds that hold the solution: by both methods, against the optimality conditions of the dense
// problem and a scan.
#include <doctest/doctest.h>

#include <cmath>

#include "dense_reference.hpp"
#include "numerics/decompositions.hpp"
#include "sepcal/fit.hpp"
#include "simulated_records.hpp"

namespace fit_bounds_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::FitStatus;
using sepcal::SecondStage;
using sepcal::test::Simulated;

namespace {

VectorXd noise_of(const Fit& result) {
  VectorXd noise(static_cast<Index>(result.noise.size()));
  for (Index j = 0; j < noise.size(); ++j)
    noise[j] = result.noise[static_cast<std::size_t>(j)].value;
  return noise;
}

/// Karush-Kuhn-Tucker: within bounds, no step left over the free ones, the cost falling beyond the
/// active ones.
void check_optimal(const Simulated& simulated, const Fit& result) {
  const MatrixXd rows = sepcal::test::whiten(
      sepcal::test::dense_rows(*simulated.model, simulated.record, result.xi1(), result.xi2()),
      noise_of(result));
  const Index n = rows.cols() - 1;
  const VectorXd r = rows.col(n);
  std::vector<Index> inside;
  for (Index k = 0; k < n; ++k) {
    const auto& p = result.parameters[static_cast<std::size_t>(k)];
    CAPTURE(p.name);
    CHECK(p.value >= p.lower);
    CHECK(p.value <= p.upper);
    CHECK(p.at_bound == (p.value == p.lower || p.value == p.upper));
    CHECK(std::isnan(p.standard_error) == p.at_bound);
    const double slope = -rows.col(k).dot(r);  // of the cost
    if (p.at_bound && p.value == p.lower) CHECK(slope >= 0);
    if (p.at_bound && p.value == p.upper) CHECK(slope <= 0);
    if (!p.at_bound) inside.push_back(k);
  }
  const MatrixXd J = rows(Eigen::all, inside);
  const MatrixXd inverse = (J.transpose() * J).inverse();
  const VectorXd step = inverse * (J.transpose() * r);
  CHECK(step.cwiseQuotient(inverse.diagonal().cwiseSqrt()).cwiseAbs().maxCoeff() < 1e-6);
}

FitOptions with_bounds(std::map<std::string, sepcal::Interval> bounds, SecondStage method) {
  FitOptions options;
  options.samples = 100;
  options.bounds = std::move(bounds);
  options.second_stage = method;
  return options;
}

}  // namespace

TEST_CASE("an active bound on a nonlinear parameter holds in both methods") {
  const Simulated flight = sepcal::test::simulate_five_hole(300);
  for (const auto method : {SecondStage::joint, SecondStage::projected}) {
    const Fit result = sepcal::fit(*flight.model, flight.record,
                                   with_bounds({{"lambda_alpha", {-0.5, 0.05}}}, method));
    CHECK(result.status == FitStatus::converged);
    CHECK(result.second_stage == method);
    CHECK(result["lambda_alpha"].value == 0.05);
    CHECK(result["lambda_alpha"].at_bound);
    CHECK(result.covariance.row(5).array().isNaN().all());
    CHECK(std::isfinite(result["b_alpha"].standard_error));
    check_optimal(flight, result);
  }
}

TEST_CASE("an active bound on a linear parameter makes projected fall back to joint, and say so") {
  const Simulated flight = sepcal::test::simulate_five_hole(300);
  for (const auto method : {SecondStage::joint, SecondStage::projected}) {
    const Fit result =
        sepcal::fit(*flight.model, flight.record, with_bounds({{"w_n", {3.3, 9}}}, method));
    CHECK(result.status == FitStatus::converged);
    CHECK(result.second_stage == SecondStage::joint);
    CHECK(result["w_n"].value == 3.3);
    check_optimal(flight, result);
    const bool said = result.message.find("fell back to joint") != std::string::npos &&
                      result.message.find("w_n") != std::string::npos;
    CHECK(said == (method == SecondStage::projected));
  }
}

TEST_CASE("a bound that comes in the way only as R settles makes projected fall back as well") {
  // w_d at the first R, which a wide tolerance stops at, and at the last; the bound lies between.
  const Simulated flight = sepcal::test::simulate_five_hole(300, 20.0);
  FitOptions options = with_bounds({}, SecondStage::projected);
  options.noise_tolerance = 1e9;
  const double first = sepcal::fit(*flight.model, flight.record, options)["w_d"].value;
  options.noise_tolerance = 1e-10;
  const double last = sepcal::fit(*flight.model, flight.record, options)["w_d"].value;
  REQUIRE(first != last);
  const double bound = 0.5 * (first + last);
  options.bounds["w_d"] = first > last ? sepcal::Interval{bound, 50} : sepcal::Interval{-50, bound};
  const Fit result = sepcal::fit(*flight.model, flight.record, options);
  CHECK(result["w_d"].at_bound);
  CHECK(result["w_d"].value == bound);
  CHECK(result.second_stage == SecondStage::joint);
  CHECK(result.message.find("fell back to joint, because the bound of w_d") != std::string::npos);
  check_optimal(flight, result);
}

TEST_CASE("two bounds at once, one linear and one nonlinear") {
  for (const Simulated& simulated :
       {sepcal::test::simulate_five_hole(300), sepcal::test::simulate_magnetometer(300)}) {
    CAPTURE(simulated.name);
    const auto& tables = simulated.model->tables();
    const std::map<std::string, sepcal::Interval> bounds{
        {tables.linear[0].name, {simulated.xi1[0] - 1, simulated.xi1[0] - 0.03}},
        {tables.nonlinear[2].name, {simulated.xi2[2] + 0.05, 0.45}}};
    for (const auto method : {SecondStage::joint, SecondStage::projected}) {
      const Fit result =
          sepcal::fit(*simulated.model, simulated.record, with_bounds(bounds, method));
      CHECK(result.status == FitStatus::converged);
      CHECK(result[tables.linear[0].name].at_bound);
      CHECK(result[tables.nonlinear[2].name].at_bound);
      check_optimal(simulated, result);
    }
  }
}

TEST_CASE("the bounded minimum is the least of a scan over the free parameter") {
  // z = (1 + a) cos(eta + b) + c with a at most 0.3: scan b, solve c by its mean.
  const Simulated wave = sepcal::test::simulate_scalar_1(150);
  const Fit result =
      sepcal::fit(*wave.model, wave.record, with_bounds({{"a", {-1, 0.3}}}, SecondStage::joint));
  CHECK(result["a"].value == 0.3);
  const auto eta = wave.record.column("eta");
  const auto z = wave.record.column("z");
  const auto mean_square = [&](double b) {
    double sum = 0;
    double square = 0;
    for (std::size_t k = 0; k < 150; ++k) {
      const double r = z[k] - 1.3 * std::cos(eta[k] + b);
      sum += r / 150;
      square += r * r / 150;
    }
    return square - sum * sum;
  };
  double best = -0.5;
  for (double width : {1e-3, 1e-6}) {
    const double centre = width == 1e-3 ? 0.0 : best;
    for (int i = -1000; i <= 1000; ++i) {
      const double b = centre + 0.5 * width * i;
      if (mean_square(b) < mean_square(best)) best = b;
    }
  }
  CHECK(result["b"].value == Approx(best).epsilon(1e-5));
  CHECK(result.rmse[0].value == Approx(std::sqrt(mean_square(best))).epsilon(1e-9));
}

TEST_CASE("a bound that the solution doesn't reach changes nothing") {
  const Simulated flight = sepcal::test::simulate_five_hole(300);
  const Fit free =
      sepcal::fit(*flight.model, flight.record, with_bounds({}, SecondStage::projected));
  const Fit loose = sepcal::fit(
      *flight.model, flight.record,
      with_bounds({{"w_n", {2, 4}}, {"lambda_va", {-0.5, 0.5}}}, SecondStage::projected));
  CHECK(loose.second_stage == SecondStage::projected);
  for (std::size_t k = 0; k < 10; ++k) {
    CHECK(std::abs(loose.parameters[k].value - free.parameters[k].value) <
          1e-8 * free.parameters[k].standard_error);
  }
}

}  // namespace fit_bounds_test
