// SPDX-License-Identifier: BSD-3-Clause
// The two-stage fit where no bound is active: both methods, threads, segments, fixed parameters,
// what a record leaves open.
#include "sepcal/fit.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "dense_reference.hpp"
#include "sepcal/error.hpp"
#include "simulated_records.hpp"
#include "small_models.hpp"

namespace fit_test {

using doctest::Approx;
using doctest::Contains;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::FitStatus;
using sepcal::SecondStage;
using sepcal::test::Simulated;

namespace {

FitOptions quick(int samples = 100) {
  FitOptions options;
  options.samples = samples;
  return options;
}

Fit fit(const Simulated& simulated, const FitOptions& options) {
  return sepcal::fit(*simulated.model, simulated.record, options);
}

/// a = b to `tolerance` of the larger of value and standard error, standard errors to 1e-6.
void check_same(const Fit& a, const Fit& b, double tolerance) {
  for (std::size_t k = 0; k < a.parameters.size(); ++k) {
    const auto& p = a.parameters[k];
    const auto& q = b.parameters[k];
    CAPTURE(p.name);
    CHECK(std::abs(p.value - q.value) <=
          tolerance * std::max(std::abs(q.value), q.standard_error_white));
    CHECK(p.standard_error_white == Approx(q.standard_error_white).epsilon(1e-6));
  }
}

}  // namespace

TEST_CASE("joint and projected agree to 1e-8, and so does a start from the middle of the bounds") {
  for (const Simulated& simulated : sepcal::test::simulate_all(400)) {
    CAPTURE(simulated.name);
    FitOptions options = quick();
    options.second_stage = SecondStage::joint;
    const Fit joint = fit(simulated, options);
    CHECK(joint.status == FitStatus::converged);
    CHECK(joint.second_stage == SecondStage::joint);
    options.second_stage = SecondStage::projected;
    const Fit projected = fit(simulated, options);
    CHECK(projected.status == FitStatus::converged);
    CHECK(projected.second_stage == SecondStage::projected);
    check_same(projected, joint, 1e-8);
    CHECK(projected.cost == Approx(joint.cost).epsilon(1e-12));

    options.samples = 0;
    options.second_stage = SecondStage::automatic;
    const Fit unsampled = fit(simulated, options);
    CHECK(unsampled.second_stage == SecondStage::joint);  // nothing is known about minima
    check_same(unsampled, joint, 1e-8);
  }
}

TEST_CASE("the truth lies within a few standard errors, automatic takes projected where it may") {
  for (const Simulated& simulated : sepcal::test::simulate_all(1000)) {
    CAPTURE(simulated.name);
    const Fit result = fit(simulated, quick(300));
    CHECK(result.status == FitStatus::converged);
    CHECK(result.stage_one.unique_minimum);
    CHECK(result.second_stage == SecondStage::projected);
    VectorXd truth(simulated.xi1.size() + simulated.xi2.size());
    truth << simulated.xi1, simulated.xi2;
    for (Index k = 0; k < truth.size(); ++k) {
      const auto& parameter = result.parameters[static_cast<std::size_t>(k)];
      CAPTURE(parameter.name);
      CHECK(std::abs(parameter.value - truth[k]) < 4.5 * parameter.standard_error);
      CHECK(parameter.standard_error == Approx(parameter.standard_error_white).epsilon(0.1));
      CHECK_FALSE(parameter.at_bound);
    }
    CHECK(result.xi1().size() == simulated.xi1.size());
    CHECK(result.xi2().size() == simulated.xi2.size());
    CHECK(result.rows == 1000);
  }
}

TEST_CASE("any number of threads gives the same fit, bit for bit") {
  const Simulated flight = sepcal::test::simulate_five_hole(20'000);
  FitOptions options = quick(20);
  options.threads = 1;
  const Fit one = fit(flight, options);
  for (const int threads : {2, 3}) {
    options.threads = threads;
    const Fit several = fit(flight, options);
    CHECK(several.values() == one.values());
    CHECK(several.covariance == one.covariance);
    CHECK(several.cost == one.cost);
    CHECK(several.iterations == one.iterations);
  }
}

TEST_CASE("a noise-free record gives back its parameters, and a finite cost") {
  for (const Simulated& simulated : sepcal::test::simulate_all(200, 0.0)) {
    for (const auto method : {SecondStage::joint, SecondStage::projected}) {
      CAPTURE(simulated.name);
      FitOptions options = quick();
      options.second_stage = method;
      const Fit result = fit(simulated, options);
      CHECK(result.status == FitStatus::converged);
      CHECK(std::isfinite(result.cost));
      CHECK((result.xi1() - simulated.xi1).norm() < 1e-9 * (1 + simulated.xi1.norm()));
      CHECK((result.xi2() - simulated.xi2).norm() < 1e-9);
      for (const auto& noise : result.noise) CHECK(noise.value > 0);
    }
  }
}

TEST_CASE("fixed parameters give the fit of the model that is left, and stand in their places") {
  const Simulated flight = sepcal::test::simulate_five_hole(300);
  FitOptions options = quick();
  options.fix = {{"w_d", 0.0}, {"lambda_beta", -0.1}};
  const Fit held = fit(flight, options);
  CHECK(held.status == FitStatus::converged);
  REQUIRE(held.parameters.size() == 10);
  CHECK(held["w_d"].fixed);
  CHECK(held["w_d"].value == 0.0);
  CHECK(std::isnan(held["w_d"].standard_error));
  CHECK(held["lambda_beta"].value == -0.1);
  CHECK(held.covariance.row(4).array().isNaN().all());

  // A dense Gauss-Newton step over the free parameters is nothing, and SEs are its inverse's.
  const VectorXd noise =
      Eigen::Vector3d(held.noise[0].value, held.noise[1].value, held.noise[2].value);
  const MatrixXd rows = sepcal::test::whiten(
      sepcal::test::dense_rows(*flight.model, flight.record, held.xi1(), held.xi2()), noise);
  const MatrixXd J = rows(Eigen::all, {0, 1, 2, 3, 5, 6, 8, 9});
  const MatrixXd inverse = (J.transpose() * J).inverse();
  const VectorXd step = inverse * (J.transpose() * rows.rightCols<1>());
  CHECK((step.cwiseQuotient(inverse.diagonal().cwiseSqrt())).cwiseAbs().maxCoeff() < 1e-7);
  CHECK(held["eps_phi"].standard_error_white ==
        Approx(std::sqrt(inverse(7, 7) * 900.0 / (900.0 - 8.0))).epsilon(1e-6));
}

TEST_CASE("nothing linear, or nothing nonlinear, is fitted like anything else") {
  sepcal::test::Draws draws(81);
  sepcal::Record record;
  const VectorXd noise = VectorXd::Constant(1, 0.01);
  record.add("u", draws.uniform_column(100, 0, 2));
  const auto growth = sepcal::block_model(sepcal::test::Growth{});
  sepcal::test::add_outputs(record, *growth, VectorXd(0), VectorXd::Constant(1, 0.3), noise, draws);
  for (const auto method : {SecondStage::joint, SecondStage::projected}) {
    FitOptions options = quick(20);
    options.second_stage = method;
    const Fit result = sepcal::fit(*growth, record, options);
    CHECK(result.status == FitStatus::converged);
    const MatrixXd rows = sepcal::test::dense_rows(*growth, record, VectorXd(0), result.xi2());
    const double D_square = rows.col(0).squaredNorm();
    CHECK(std::abs(rows.col(0).dot(rows.col(1))) < 1e-8 * std::sqrt(D_square));
    CHECK(result["c"].standard_error_white ==
          Approx(std::sqrt(rows.col(1).squaredNorm() / 99.0 / D_square)).epsilon(1e-6));

    sepcal::Record line;
    line.add("u", {0, 1, 2, 3}).add("z", {1.1, 2.9, 5.1, 6.9});
    const Fit straight = sepcal::fit(sepcal::test::Line{}, line, options);
    CHECK(straight.status == FitStatus::converged);
    CHECK(straight["s"].value == Approx(1.96));
    CHECK(straight["s"].standard_error == Approx(std::sqrt(0.032 / 2 / 5)));  // textbook regression
    CHECK(straight["c"].standard_error == Approx(std::sqrt(0.032 / 2 * 14 / 20)));
  }
}

TEST_CASE("every linear parameter fixed leaves a fit of the nonlinear ones") {
  const Simulated wave = sepcal::test::simulate_scalar_1(200);
  FitOptions options = quick();
  options.fix = {{"a", 0.5}, {"c", -0.3}};
  const Fit result = fit(wave, options);
  CHECK(result.status == FitStatus::converged);
  const MatrixXd rows =
      sepcal::test::dense_rows(*wave.model, wave.record, result.xi1(), result.xi2());
  CHECK(std::abs(rows.col(2).dot(rows.col(3))) < 1e-8 * rows.col(2).norm());
}

TEST_CASE("each stage uses its own segments") {
  Simulated wave = sepcal::test::simulate_scalar_1(300);
  wave.record.cut({{"one", 0, 120}, {"two", 120, 300}});
  FitOptions options = quick();
  options.stage_one_segments = "one";
  options.stage_two_segments = "two";
  const Fit result = fit(wave, options);
  CHECK(result.rows == 180);
  options = quick();
  wave.record.cut({{"two", 120, 300}});
  check_same(result, fit(wave, options), 1e-8);
}

TEST_CASE("what a record can't tell apart is a status that names the combination") {
  // Always heading north and level: w_n, lambda_va and b_va enter vn alone, at one airspeed.
  Simulated flight = sepcal::test::simulate_five_hole(100);
  sepcal::Record record;
  for (const auto& input : flight.model->tables().inputs) {
    if (!flight.record.has(input.name)) continue;
    const auto column = flight.record.column(input.name);
    const bool varied = input.name == "dpa" || input.name == "dpb";
    std::vector<double> values(100, input.name == "pt"   ? 95'250.0
                                    : input.name == "ps" ? 95'000.0
                                                         : 0.0);
    if (input.name == "rho") values.assign(100, 1.2);
    if (varied) values.assign(column.begin(), column.end());
    record.add(input.name, values);
  }
  sepcal::test::Draws draws(82);
  sepcal::test::add_outputs(record, *flight.model, flight.xi1, flight.xi2,
                            Eigen::Vector3d(0.1, 0.1, 0.1), draws);
  for (const auto method : {SecondStage::joint, SecondStage::projected}) {
    FitOptions options = quick();
    options.second_stage = method;
    const Fit result = sepcal::fit(*flight.model, record, options);
    CHECK(result.status == FitStatus::not_identifiable);
    CHECK(result.message.find("lambda_va") != std::string::npos);
    CHECK(result.message.find("can't be told apart") != std::string::npos);
    CHECK_FALSE(result.identifiability.unobservable.empty());
    CHECK(result.values().allFinite());
    CHECK(std::isfinite(result.cost));
  }
}

TEST_CASE("a parameter is found by name, a name that isn't there is an error that lists them") {
  const Simulated wave = sepcal::test::simulate_scalar_1(50);
  const Fit result = fit(wave, quick(10));
  CHECK(result["b"].unit == "rad");
  CHECK(&result["b"] == &result.parameters[2]);
  CHECK_THROWS_WITH_AS((void)result["d"], Contains("no parameter 'd'; the fit has: a, c, b"),
                       sepcal::Error);
  CHECK(sepcal::to_string(FitStatus::not_identifiable) == "not_identifiable");
  CHECK(sepcal::to_string(FitStatus::not_converged) == "not_converged");
  CHECK(sepcal::to_string(FitStatus::converged) == "converged");
  CHECK(sepcal::to_string(SecondStage::automatic) == "auto");
  CHECK(sepcal::to_string(SecondStage::joint) == "joint");
  CHECK(sepcal::to_string(SecondStage::projected) == "projected");
}

TEST_CASE("a model that is not finite in some rows is refused whatever the stages") {
  sepcal::Record record;
  record.add("u", {4, -1, 9, 16}).add("z", {2, 1, 3, 4});
  CHECK_THROWS_WITH_AS(sepcal::fit(sepcal::test::Root{}, record), Contains("not finite"),
                       sepcal::Error);
}

}  // namespace fit_test
