// SPDX-License-Identifier: BSD-3-Clause
// Equation error, the two-step method and output error on flights of the simulated aircraft.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <string>

#include "aircraft_records.hpp"
#include "sepcal/aircraft/output_error.hpp"
#include "sepcal/aircraft/two_step.hpp"
#include "sepcal/error.hpp"
#include "trajectories.hpp"

namespace aircraft_fit_test {

using doctest::Contains;
using sepcal::AeroFit;
using sepcal::AircraftAxes;
using sepcal::AircraftTruth;
using sepcal::Fit;
using sepcal::FitStatus;
using sepcal::RateReference;
using sepcal::Record;
using sepcal::simulate_aircraft;
using sepcal::test::record_of;
using sepcal::test::without_noise;

namespace {

AircraftTruth away_from_cg(RateReference reference) {
  AircraftTruth truth = without_noise();
  truth.geometry.imu = {0.4, 0.1, -0.2};
  truth.geometry.vane = {1.2, -3.5, 0.1};
  truth.geometry.rate_reference = reference;
  truth.parameters["CX_q"] = 0.3;
  truth.parameters["CX_elevator"] = 0.05;
  return truth;
}

/// The largest error, of the parameter's size, of 0.01 at least, or of 2 m/s of the wind.
double worst_error(const Fit& fit, const AircraftTruth& truth) {
  double worst = 0.0;
  std::string at_worst;
  for (const sepcal::Parameter& parameter : fit.parameters) {
    const auto at = truth.parameters.find(parameter.name);
    if (at == truth.parameters.end()) continue;
    const double least = parameter.name.starts_with("w_") ? 2.0 : 0.01;
    const double size = std::max(std::abs(at->second), least);
    const double error = std::abs(parameter.value - at->second) / size;
    if (error > worst) at_worst = parameter.name;
    worst = std::max(worst, error);
  }
  MESSAGE("worst: ", at_worst, " by ", worst, " of its size");
  return worst;
}

/// Weights of the usual sensors: readings without noise have none of their own.
sepcal::FitOptions known_noise(const std::vector<std::string>& outputs) {
  sepcal::FitOptions options{.coloured_errors = false, .threads = 1};
  for (const std::string& name : outputs) options.noise[name] = AircraftTruth{}.noise.at(name);
  return options;
}

const std::vector<std::string> of_six{"airspeed", "beta", "alpha", "roll", "pitch", "ax",
                                      "ay",       "az",   "p",     "q",    "r"};
const std::vector<std::string> of_path{"airspeed", "beta", "alpha", "roll", "pitch",
                                       "yaw",      "vn",   "ve",    "vd"};

sepcal::FitOptions plain() { return {.coloured_errors = false, .threads = 1}; }

}  // namespace

TEST_CASE("equation error finds the coefficients of a flight without noise, by either reference") {
  for (const auto reference :
       {RateReference::chord_per_speed, RateReference::chord_per_twice_speed}) {
    const AircraftTruth truth = away_from_cg(reference);
    const Record record = record_of(simulate_aircraft(truth, {.rate = 100}));
    const AeroFit found =
        sepcal::fit_equation_error(sepcal::aero_coefficients(record, truth.geometry), {}, plain());
    CHECK(worst_error(found.fit, truth) < 0.1);  // what a window of 0.06 s smooths away
  }
}

TEST_CASE("output error finds them with six degrees of freedom, by either reference") {
  for (const auto reference :
       {RateReference::chord_per_speed, RateReference::chord_per_twice_speed}) {
    const AircraftTruth truth = away_from_cg(reference);
    const Record record = record_of(simulate_aircraft(truth));
    const AeroFit found =
        sepcal::fit_output_error(record, truth.geometry, {.fit = known_noise(of_six)});
    CHECK(found.fit.status == FitStatus::converged);
    CHECK(worst_error(found.fit, truth) < 0.05);  // a sweep is no line between rows
    CHECK(found.warning.empty());
    CHECK(found.notes.front().starts_with(
        reference == RateReference::chord_per_speed ? "q_hat is q c/V" : "q_hat is q c/2V"));
  }
}

TEST_CASE("longitudinal and lateral, with the other states measured") {
  AircraftTruth truth = away_from_cg(RateReference::chord_per_twice_speed);
  truth.geometry.vane = truth.geometry.cg;
  truth.geometry.imu = truth.geometry.cg;
  const Record record = record_of(simulate_aircraft(truth));
  const std::vector<std::string> of_symmetry{"airspeed", "alpha", "pitch", "ax", "az", "q"};
  const std::vector<std::string> of_sides{"beta", "roll", "ay", "p", "r"};
  for (const auto axes : {AircraftAxes::longitudinal, AircraftAxes::lateral}) {
    const auto& outputs = axes == AircraftAxes::longitudinal ? of_symmetry : of_sides;
    const AeroFit found = sepcal::fit_output_error(record, truth.geometry,
                                                   {.axes = axes, .fit = known_noise(outputs)});
    CHECK(found.warning == sepcal::measured_warning);
    CHECK(found.fit.status == FitStatus::converged);
    CHECK(worst_error(found.fit, truth) < 0.05);
  }
}

TEST_CASE("the two-step method takes the sensors' errors off before it looks at the forces") {
  AircraftTruth truth = away_from_cg(RateReference::chord_per_twice_speed);
  for (const auto& [name, value] : std::map<std::string, double>{{"b_ax", 0.15},
                                                                 {"b_ay", -0.1},
                                                                 {"b_az", 0.2},
                                                                 {"b_p", 2e-3},
                                                                 {"b_q", -3e-3},
                                                                 {"b_r", 1.5e-3},
                                                                 {"lambda_v", -0.03},
                                                                 {"lambda_alpha", -0.08},
                                                                 {"w_n", 4.0}}) {
    truth.parameters[name] = value;
  }
  const Record record = record_of(simulate_aircraft(truth, {.rate = 100}));
  const sepcal::TwoStep found = sepcal::two_step(
      record, truth.geometry, {.path_fit = known_noise(of_path), .aero_fit = plain()});
  CHECK(found.path.status == FitStatus::converged);
  CHECK(worst_error(found.path, truth) < 0.05);
  CHECK(worst_error(found.aero.fit, truth) < 0.1);
  CHECK(found.aero.warning == sepcal::regressor_warning);
  const AeroFit one_step =
      sepcal::fit_equation_error(sepcal::aero_coefficients(record, truth.geometry), {}, plain());
  CHECK(std::abs(one_step.fit["CZ_alpha"].value + 4.8) > 0.2);  // of the scale of alpha, 8 %
}

TEST_CASE("regressors of one's own, where a simulated aircraft has them") {
  AircraftTruth truth;
  truth.effects = {{"Cm[alpha^2]", {4.0}}};
  const Record record = record_of(simulate_aircraft(truth, {.seed = 3}));
  const std::vector<sepcal::AeroEquation> equations{
      {"CX", {"1", "alpha", "alpha^2"}},
      {"CZ", {"1", "alpha", "q_hat", "elevator"}},
      {"Cm", {"1", "alpha", "q_hat", "elevator", "alpha^2"}}};
  const AeroFit found = sepcal::fit_output_error(
      record, truth.geometry,
      {.axes = AircraftAxes::longitudinal, .equations = equations, .fit = plain()});
  CHECK(found.fit.status == FitStatus::converged);
  const sepcal::Parameter& squared = found.fit["Cm_alpha^2"];
  CHECK(std::abs(squared.value - 4.0) < 4.0 * squared.standard_error);
  CHECK(squared.standard_error < 1.0);
}

TEST_CASE("its derivatives are those of differences") {
  AircraftTruth truth = away_from_cg(RateReference::chord_per_speed);
  Record record = record_of(simulate_aircraft(truth, {.rate = 50}));
  record.add("mass", std::vector<double>(record.length(), 1000.0));
  record.cut({{"pull", 60, 120}, {"turn", 740, 800}});
  sepcal::FitOptions at_truth;
  for (const auto& [name, value] : truth.parameters) {
    if (name.starts_with("C")) at_truth.start[name] = value;
  }
  sepcal::TrajectoryOptions along;
  along.outputs = {"airspeed", "beta", "alpha", "yaw", "ax", "ay", "az", "p", "q", "r", "vn", "vd"};
  const sepcal::AircraftTrajectory laid =
      sepcal::lay_aircraft(record, truth.geometry, {.trajectory = along, .fit = at_truth});
  const sepcal::Tables& tables = laid.model->tables();
  Eigen::VectorXd xi2(tables.n_2());
  for (int i = 0; i < tables.n_2(); ++i) {
    xi2[i] = laid.fit.start.at(tables.nonlinear[static_cast<std::size_t>(i)].name);
  }
  const Eigen::VectorXd xi1 = Eigen::VectorXd::LinSpaced(tables.n_1(), -0.1, 0.1);
  CHECK(sepcal::test::error_of_tangent(*laid.model, laid.record, xi2, xi1) < 1e-7);
}

TEST_CASE("an equation of one coefficient leaves the others theirs: no lift, no flight") {
  const AircraftTruth truth;
  const Record record = record_of(simulate_aircraft(truth, {.rows = 400}));
  const sepcal::AircraftTrajectory laid = sepcal::lay_aircraft(
      record, truth.geometry,
      {.axes = sepcal::AircraftAxes::longitudinal, .equations = {{"Cm", {"1", "alpha"}}}});
  std::map<std::string, std::size_t> count;
  for (const auto& [coefficient, regressors] : laid.equations)
    count[coefficient] = regressors.size();
  CHECK(count == std::map<std::string, std::size_t>{{"CX", 5}, {"CZ", 4}, {"Cm", 2}});
}

TEST_CASE("what can't be is refused in one line") {
  const AircraftTruth truth;
  const Record record = record_of(simulate_aircraft(truth, {.rows = 400}));
  const auto refuse = [&](const sepcal::OutputErrorOptions& options, const char* message) {
    CHECK_THROWS_WITH_AS(sepcal::lay_aircraft(record, truth.geometry, options), Contains(message),
                         sepcal::Error);
  };
  sepcal::AeroEquation long_one{"Cm", {"1"}};
  for (int i = 1; i < 10; ++i) {
    for (const char* variable : {"alpha", "q_hat", "elevator", "beta", "rudder"}) {
      long_one.regressors.push_back(std::string(variable) + "^" + std::to_string(i));
    }
  }
  refuse({.equations = {long_one}}, "73 regressors; 40 is the most");
  refuse({.equations = {{"Cm", {"1", "flaps"}}}}, "the regressor 'flaps', which is no column");
  refuse({.free = {"b_gear"}}, "'b_gear' is not held; those that may be freed are: lambda_v");
  refuse({.trajectory = {.measured = {"height"}}}, "the model has no state 'height'");
  CHECK_THROWS_WITH_AS(sepcal::find_aircraft_axes("vertical"),
                       Contains("choose longitudinal, lateral or six-dof"), sepcal::Error);
  sepcal::AircraftGeometry light = truth.geometry;
  light.inertia = {};
  CHECK_THROWS_WITH_AS(sepcal::fit_output_error(record, light, {.equations = {{"CZ", {"1"}}}}),
                       Contains("output error needs the aircraft's inertia"), sepcal::Error);
}

}  // namespace aircraft_fit_test
