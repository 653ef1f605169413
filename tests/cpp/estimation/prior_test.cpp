// SPDX-License-Identifier: BSD-3-Clause
// Priors of parameters, against the closed form of a linear model.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "numerics/decompositions.hpp"
#include "sepcal/fit.hpp"
#include "simulated_records.hpp"
#include "small_models.hpp"

namespace prior_test {

using doctest::Approx;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::FitStatus;
using sepcal::Record;
using sepcal::test::Line;

namespace {

constexpr Eigen::Index rows = 40;

/// z = 2 u + 1 and noise of 0.5.
struct LineRecord {
  MatrixXd J{rows, 2};
  VectorXd z;
  Record record;

  LineRecord() {
    sepcal::test::Draws draws(8);
    const std::vector<double> u = draws.uniform_column(rows, -1.0, 3.0);
    J.col(0) = Eigen::Map<const VectorXd>(u.data(), rows);
    J.col(1).setOnes();
    z = J * Vector2d(2.0, 1.0) + 0.5 * draws.normal_matrix(rows, 1);
    record.add("u", u).add("z", {z.begin(), z.end()});
  }
};

/// z = (a + b) u: only the sum is seen.
struct Sum {
  static constexpr std::array inputs{sepcal::Quantity{"u", "1"}};
  static constexpr std::array outputs{sepcal::Quantity{"z", "1"}};
  static constexpr std::array linear{sepcal::Quantity{"a", "1"}, sepcal::Quantity{"b", "1"}};
  static constexpr std::array<sepcal::Quantity, 0> nonlinear{};
  template <class U, class X>
  sepcal::Affine<X, 1, 2> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 0>&) const {
    sepcal::Affine<X, 1, 2> z;
    z.A << u[0], u[0];
    z.b << X(0.0);
    return z;
  }
};

}  // namespace

TEST_CASE("with R given the estimate and its covariance are Bayes'") {
  const LineRecord line;
  FitOptions options;
  options.noise = {{"z", 0.5}};
  options.coloured_errors = false;
  options.prior = {{"s", {2.5, 0.05}}};
  const Fit fit = sepcal::fit(Line{}, line.record, options);
  const MatrixXd W = Vector2d(1.0 / (0.05 * 0.05), 0.0).asDiagonal();
  const MatrixXd H = line.J.transpose() * line.J / 0.25 + W;
  const VectorXd expected =
      H.inverse() * (line.J.transpose() * line.z / 0.25 + W * Vector2d(2.5, 0.0));
  CHECK((fit.values() - expected).norm() < 1e-10);
  CHECK((fit.covariance - H.inverse()).norm() < 1e-10 * H.inverse().norm());
  const VectorXd r = line.z - line.J * expected;
  const double misfit = r.squaredNorm() / 0.25 + std::pow((expected[0] - 2.5) / 0.05, 2);
  CHECK(fit.cost == Approx(0.5 * misfit + rows * std::log(0.5)).epsilon(1e-12));
  CHECK(fit.rmse[0].value == Approx(r.norm() / std::sqrt(double{rows})).epsilon(1e-12));
}

TEST_CASE("with R estimated a prior keeps its own size, and spends less of the freedom") {
  const LineRecord line;
  FitOptions options;
  options.coloured_errors = false;
  for (const double sd : {1e-6, 0.1, 1e6}) {
    CAPTURE(sd);
    options.prior = {{"s", {2.0, sd}}};
    const Fit fit = sepcal::fit(Line{}, line.record, options);
    const VectorXd r = line.z - line.J * fit.values();
    const double variance = r.squaredNorm() / rows;  // Eq. 24
    CHECK(fit.noise[0].value == Approx(std::sqrt(variance)).epsilon(1e-9));
    const MatrixXd W = Vector2d(1.0 / (sd * sd), 0.0).asDiagonal();
    const MatrixXd data = line.J.transpose() * line.J / variance;
    CHECK((data * fit.values() + W * fit.values() - line.J.transpose() * line.z / variance -
           W * Vector2d(2.0, 0.0))
              .norm() < 1e-6 * data.norm());
    const double spent = 2.0 - (W * (data + W).inverse()).trace();  // 1 where s is as good as fixed
    const MatrixXd H = data * (rows - spent) / rows + W;
    CHECK((fit.covariance - H.inverse()).norm() < 1e-7 * H.inverse().norm());
  }
}

TEST_CASE("a result far from its prior, or less sure, is said") {
  sepcal::test::Draws draws(31);
  std::vector<double> u = draws.uniform_column(600, -1, 1);
  std::ranges::sort(u);  // slow, so that coloured noise matters
  std::vector<double> z;
  double e = 0.0;
  for (const double x : u) {
    e = 0.9 * e + 0.1 * draws.normal();
    z.push_back(2.0 * x + 1.0 + e);
  }
  Record record;
  record.add("u", u).add("z", z);
  FitOptions options;
  const Fit ignorant = sepcal::fit(Line{}, record, options);
  const double sure = 0.5 * ignorant["s"].standard_error;
  REQUIRE(sure > 2.0 * ignorant["s"].standard_error_white);

  options.prior = {{"s", {ignorant["s"].value, 2.0 * ignorant["s"].standard_error}}};
  CHECK(sepcal::fit(Line{}, record, options).message.empty());
  options.prior = {{"s", {ignorant["s"].value, sure}}};
  const Fit loud = sepcal::fit(Line{}, record, options);
  CHECK(loud.message.find("'s' is less sure than its prior") != std::string::npos);
  // Weighed as it says, both are as sure as their precisions' sum.
  const double factor = ignorant["s"].standard_error / ignorant["s"].standard_error_white;
  options.noise = {{"z", factor * ignorant.noise[0].value}};
  const Fit weighed = sepcal::fit(Line{}, record, options);
  CHECK(weighed.message.empty());
  CHECK(weighed["s"].standard_error == Approx(sure / std::sqrt(1.25)).epsilon(0.05));

  options.noise.clear();
  options.prior = {{"s", {ignorant["s"].value + 30.0 * sure, sure}}};
  CHECK(sepcal::fit(Line{}, record, options).message.find("far from its prior") !=
        std::string::npos);
}

TEST_CASE("a prior that is certain fixes, a loose one leaves free") {
  const LineRecord line;
  FitOptions free;
  const Fit without = sepcal::fit(Line{}, line.record, free);
  free.prior = {{"s", {7.0, 1e6}}};
  CHECK((sepcal::fit(Line{}, line.record, free).values() - without.values()).norm() < 1e-8);
  FitOptions held;
  held.fix = {{"s", 2.2}};
  FitOptions certain;
  certain.prior = {{"s", {2.2, 1e-7}}};
  const Fit fixed = sepcal::fit(Line{}, line.record, held);
  const Fit known = sepcal::fit(Line{}, line.record, certain);
  CHECK(known["c"].value == Approx(fixed["c"].value).epsilon(1e-9));
  CHECK(known["c"].standard_error == Approx(fixed["c"].standard_error).epsilon(1e-6));
}

TEST_CASE("a prior determines what a record leaves open") {
  const LineRecord line;
  CHECK(sepcal::fit(Sum{}, line.record).status == FitStatus::not_identifiable);
  FitOptions options;
  options.prior = {{"a", {0.5, 0.1}}};
  const Fit fit = sepcal::fit(Sum{}, line.record, options);
  CHECK(fit.status == FitStatus::converged);
  CHECK(fit.identifiability.unobservable.empty());
  CHECK(fit["a"].value == Approx(0.5).epsilon(1e-6));  // nothing in the record speaks against it
  CHECK(fit["a"].standard_error_white == Approx(0.1).epsilon(1e-6));
}

TEST_CASE("joint and projected agree about a nonlinear model") {
  const auto flight = sepcal::test::simulate_five_hole(300);
  FitOptions options;
  options.samples = 50;
  options.prior = {{"b_va", {-0.2, 0.1}}, {"eps_phi", {0.05, 0.002}}};
  options.second_stage = sepcal::SecondStage::joint;
  const Fit joint = sepcal::fit(*flight.model, flight.record, options);
  options.second_stage = sepcal::SecondStage::projected;
  options.jacobian = sepcal::ProjectedJacobian::golub_pereyra;
  const Fit projected = sepcal::fit(*flight.model, flight.record, options);
  REQUIRE(joint.second_stage == sepcal::SecondStage::joint);
  REQUIRE(projected.second_stage == sepcal::SecondStage::projected);
  for (const sepcal::Parameter& parameter : joint.parameters) {
    CHECK(std::abs(projected[parameter.name].value - parameter.value) <
          1e-7 * parameter.standard_error);
  }
  options.prior.clear();
  const Fit without = sepcal::fit(*flight.model, flight.record, options);
  CHECK(projected["eps_phi"].standard_error < 0.95 * without["eps_phi"].standard_error);
}

TEST_CASE("the prior of a fixed parameter, or one that is no normal, is refused") {
  const LineRecord line;
  FitOptions options;
  options.fix = {{"s", 2.0}};
  options.prior = {{"s", {2.0, 1.0}}};
  CHECK_THROWS_WITH_AS(sepcal::fit(Line{}, line.record, options), doctest::Contains("'s' is fixed"),
                       sepcal::Error);
  options.fix.clear();
  options.prior = {{"s", {2.0, 0.0}}};
  CHECK_THROWS_WITH_AS(sepcal::fit(Line{}, line.record, options),
                       doctest::Contains("positive standard deviation"), sepcal::Error);
}

}  // namespace prior_test
