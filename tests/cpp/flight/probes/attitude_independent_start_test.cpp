// SPDX-License-Identifier: BSD-3-Clause
// Where a fit to the field's strength begins: at the readings' ellipsoid, at a sphere where that is
// out of bounds, and nowhere where the unit can't be right.
#include "flight/probes/attitude_independent_start.hpp"

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "calibrated_flights.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"
#include "simulated_records.hpp"

namespace attitude_independent_start_test {

using doctest::Approx;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using namespace sepcal;
using namespace sepcal::test;

namespace {

constexpr double strength = 48.0;

const Vec<double, 9> truth{{0.08, -0.05, 0.12, 0.03, -0.02, 0.05, 12, -8, 20}};

/// 400 readings of the true sensor in a field within `cap` of the top of the sphere (2: all of it).
Record simulate(double cap, double noise, double scale = 1.0) {
  Draws draws(3);
  const Matrix3d C = AttitudeIndependentMagnetometer::soft_iron_and_scale<double>(truth);
  std::array<std::vector<double>, 3> m;
  while (m[0].size() < 400) {
    const Vector3d u = Vector3d(draws.normal_matrix(3, 1)).normalized();
    if (u[2] < 1 - cap) continue;
    const Vector3d error = noise * draws.normal_matrix(3, 1);
    const Vector3d reading = scale * (C * strength * u + truth.tail<3>() + error);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      m[axis].push_back(reading[static_cast<Eigen::Index>(axis)]);
    }
  }
  Record record;
  record.add("mx", m[0]).add("my", m[1]).add("mz", m[2]);
  return record;
}

constexpr auto& parameters = AttitudeIndependentMagnetometer::nonlinear;

Interval bounds_of(const FitOptions& options, const Quantity& parameter) {
  const auto given = options.bounds.find(std::string(parameter.name));
  if (given != options.bounds.end()) return given->second;
  return {parameter.lower, parameter.upper};
}

}  // namespace

TEST_CASE("without noise the start is the truth, n bounded two field strengths round the middle") {
  for (const double cap : {2.0, 0.7}) {
    const Record record = simulate(cap, 0.0);
    const FitOptions options = probes::start_attitude_independent({}, record, strength);
    for (std::size_t k = 0; k < 9; ++k) {
      const std::string name(parameters[k].name);
      CHECK(options.start.at(name) == Approx(truth[static_cast<int>(k)]).epsilon(1e-7));
    }
    const auto mx = record.column("mx");
    const auto [low, high] = std::ranges::minmax(mx);
    CHECK(options.bounds.at("n_x").lower == Approx((low + high) / 2 - 2 * strength));
    CHECK(options.bounds.at("n_x").upper == Approx((low + high) / 2 + 2 * strength));
    CHECK_FALSE(options.bounds.contains("lambda_x"));
  }
}

TEST_CASE("a start that is given is kept, and so are bounds") {
  FitOptions given;
  given.start = {{"n_x", 3.0}};
  given.bounds = {{"n_z", {-5, 50}}, {"lambda_x", {-0.1, 0.2}}};
  const FitOptions options =
      probes::start_attitude_independent(given, simulate(2.0, 0.1), strength);
  CHECK(options.start == given.start);
  CHECK(options.bounds.at("n_z").upper == 50);
  CHECK(options.bounds.at("lambda_x").lower == -0.1);
  CHECK(options.bounds.contains("n_x"));
}

TEST_CASE("the start is within the bounds whatever the readings cover") {
  for (const double cap : {0.3, 0.1, 0.03, 0.005}) {
    for (const double noise : {0.05, 0.5, 5.0}) {
      const FitOptions options =
          probes::start_attitude_independent({}, simulate(cap, noise), strength);
      for (const Quantity& parameter : parameters) {
        const auto [lower, upper] = bounds_of(options, parameter);
        const double start = options.start.at(std::string(parameter.name));
        CHECK(start >= lower);
        CHECK(start <= upper);
      }
    }
  }
}

TEST_CASE("the start is from stage one's segments") {
  Record record = simulate(2.0, 0.0);
  std::vector<double> mx(record.column("mx").begin(), record.column("mx").end());
  for (std::size_t i = 200; i < 400; ++i) mx[i] = 1000;
  Record spoiled;
  spoiled.add("mx", mx).add("my", {record.column("my").begin(), record.column("my").end()});
  spoiled.add("mz", {record.column("mz").begin(), record.column("mz").end()});
  spoiled.cut({{"good", 0, 200}, {"bad", 200, 400}});
  FitOptions given;
  given.stage_one_segments = given.stage_two_segments = "good";
  const FitOptions options = probes::start_attitude_independent(given, spoiled, strength);
  CHECK(options.start.at("n_x") == Approx(12).epsilon(1e-6));
}

TEST_CASE("readings in another unit than the field's strength are refused") {
  for (const double scale : {0.01, 0.3, 2.0, 1000.0}) {
    check_refused(
        [&] { probes::start_attitude_independent({}, simulate(2.0, 0.1, scale), strength); },
        {"the readings lie on an ellipsoid of", "field_strength is 48 uT",
         "beyond the bounds of lambda", "check the unit"});
  }
  FitOptions wide;
  for (const char* name : {"lambda_x", "lambda_y", "lambda_z"}) wide.bounds[name] = {-0.9, 2.0};
  const FitOptions options =
      probes::start_attitude_independent(wide, simulate(2.0, 0.0, 2.0), strength);
  CHECK(options.start.at("lambda_x") == Approx(1.16).epsilon(1e-6));
}

TEST_CASE("open bounds are refused") {
  FitOptions open;
  open.bounds["lambda_y"] = {-0.5, infinity};
  check_refused([&] { probes::start_attitude_independent(open, simulate(2.0, 0.1), strength); },
                {"'lambda_y'", "open", "two finite ones"});
}

TEST_CASE("a rotation is always listed; a bound that is met makes the fit not identifiable") {
  Fit fit;
  fit.status = FitStatus::converged;
  for (const Quantity& parameter : parameters) {
    fit.parameters.push_back({.name = std::string(parameter.name), .unit = "1"});
  }
  SUBCASE("nothing at a bound") {
    probes::judge_attitude_independent(fit, 48.0);
    CHECK(fit.status == FitStatus::converged);
    REQUIRE(fit.identifiability.unobservable.size() == 3);
    CHECK(fit.identifiability.unobservable[1].text == "eta_y");
    CHECK(fit.message.starts_with("eta_x, eta_y and eta_z can't be seen: a rotation"));
  }
  SUBCASE("lambda_z at its bound") {
    fit.parameters[2].at_bound = true;
    fit.message = "something";
    probes::judge_attitude_independent(fit, 48.0);
    CHECK(fit.status == FitStatus::not_identifiable);
    REQUIRE(fit.identifiability.unobservable.size() == 4);
    CHECK(fit.identifiability.unobservable[0].text == "lambda_z");
    CHECK(fit.message.starts_with("something; only the bound of lambda_z kept"));
  }
  SUBCASE("what did not converge stays so") {
    fit.parameters[2].at_bound = fit.parameters[3].at_bound = true;
    fit.status = FitStatus::not_converged;
    probes::judge_attitude_independent(fit, 48.0);
    CHECK(fit.status == FitStatus::not_converged);
    CHECK(fit.message.find("the bounds of lambda_z, alpha_xy kept") != std::string::npos);
  }
}

}  // namespace attitude_independent_start_test
