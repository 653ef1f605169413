// SPDX-License-Identifier: BSD-3-Clause
// What calibrations of the two probes hold beyond a fit: a wind that is held, derived quantities,
// the noise that the model itself depends on. Truth comes from simulated flights.
#include <cmath>
#include <nlohmann/json.hpp>

#include "calibrated_flights.hpp"
#include "sepcal/flight/calibration.hpp"

namespace calibration_probes_test {

using namespace sepcal;
using namespace sepcal::test;
using Json = nlohmann::ordered_json;

namespace {

CalibrationOptions quick_options() {
  CalibrationOptions options;
  options.fit.samples = 60;
  options.fit.threads = 1;
  return options;
}

Flight make_tube_flight() { return make_flight(simulate_pitot_static({}, condensed(400))); }

Calibration calibrate_tube(const CalibrationOptions& options = quick_options()) {
  return calibrate(pitot_static_probe(), make_tube_flight(), options);
}

/// A flight whose rotation is none, so that the truth is among the model's own.
SimulatedFlight simulate_strength(double noise) {
  MagnetometerTruth truth;
  for (const char* name : {"eta_x", "eta_y", "eta_z"}) truth.parameters[name] = 0.0;
  truth.noise = {noise, noise, noise};
  return simulate_magnetometer(truth, condensed(400));
}

const double strength = Vector3d(MagnetometerTruth{}.field.data()).norm();

Calibration calibrate_strength(double noise, CalibrationOptions options = quick_options()) {
  options.fit.samples = FitOptions{}.samples;  // it samples none
  return calibrate(attitude_independent_probe(strength), make_flight(simulate_strength(noise)),
                   options);
}

/// The text once it was read is the text that was written.
void check_round_trip(const Calibration& calibration) {
  const std::string text = to_json(calibration);
  CHECK(to_json(parse_calibration(text, "base.json")) == text);
}

/// Every estimate is within four and a half of its standard errors of the truth: for up to nine
/// parameters a right build fails with other seeds at most one time in 15,000.
void check_truth(const Fit& fit, const std::map<std::string, double>& truth) {
  for (const Parameter& parameter : fit.parameters) {
    if (parameter.fixed) continue;
    CAPTURE(parameter.name);
    CHECK(std::abs(parameter.value - truth.at(parameter.name)) < 4.5 * parameter.standard_error);
  }
}

}  // namespace

TEST_CASE("a Pitot-static tube: the truth within its errors, w_d held at zero") {
  const Calibration calibration = calibrate_tube();
  CHECK(calibration.fit.status == FitStatus::converged);
  // With a wind beyond the airspeed a negative scale fits somewhat too: another minimum, far worse.
  const auto& minima = calibration.fit.stage_one.minima;
  CHECK(std::abs(minima.front().xi2[0] - calibration.fit["w_n"].value) < 1e-6);
  for (std::size_t i = 1; i < minima.size(); ++i) {
    CHECK(minima[i].trace_r > 10 * minima.front().trace_r);
  }
  check_truth(calibration.fit, PitotStaticTruth{}.parameters);
  CHECK(calibration.fit["w_d"].fixed);
  CHECK(calibration.fit["w_d"].value == 0.0);
  CHECK(calibration.options.fit.fix.at("w_d") == 0.0);
  check_round_trip(calibration);
}

TEST_CASE("w_d is freed by name, fixed elsewhere, and has no bounds while it is held") {
  CalibrationOptions options = quick_options();
  options.free = {"w_d"};
  options.fit.bounds["w_d"] = {-5, 5};
  const Calibration freed = calibrate_tube(options);
  CHECK_FALSE(freed.fit["w_d"].fixed);
  CHECK(freed.fit["w_d"].upper == 5);
  check_truth(freed.fit, PitotStaticTruth{}.parameters);
  check_round_trip(freed);
  options.free.clear();
  check_refused([&] { calibrate_tube(options); }, {"bounds w_d", "held at 0", "free w_d"});
  options = quick_options();
  options.fit.fix["w_d"] = 0.4;
  CHECK(calibrate_tube(options).fit["w_d"].value == 0.4);
}

TEST_CASE("lambda_va and b_va follow by the delta method") {
  const Calibration calibration = calibrate_tube();
  REQUIRE(calibration.derived.size() == 2);
  const auto& [lambda, b] = std::tie(calibration.derived[0], calibration.derived[1]);
  CHECK(lambda.name == "lambda_va");
  CHECK(lambda.unit == "1");
  CHECK(b.name == "b_va");
  CHECK(b.unit == "m/s");
  const double s = calibration.fit["s_va"].value;
  const double c = calibration.fit["c_va"].value;
  CHECK(lambda.value == doctest::Approx(1 / s - 1).epsilon(1e-14));
  CHECK(b.value == doctest::Approx(-c / s).epsilon(1e-14));
  // Var f = f(x)' S f(x) with slopes by central differences.
  const auto error = [&](const auto& f) {
    constexpr double h = 1e-5;
    const Eigen::Vector2d slope((f(s + h, c) - f(s - h, c)) / (2 * h),
                                (f(s, c + h) - f(s, c - h)) / (2 * h));
    return std::sqrt(slope.dot(calibration.fit.covariance.topLeftCorner<2, 2>() * slope));
  };
  const auto lambda_of = [](double scale, double) { return 1 / scale - 1; };
  const auto b_of = [](double scale, double bias) { return -bias / scale; };
  CHECK(lambda.standard_error == doctest::Approx(error(lambda_of)).epsilon(1e-7));
  CHECK(b.standard_error == doctest::Approx(error(b_of)).epsilon(1e-7));
  const Json root = Json::parse(to_json(calibration));
  CHECK(root["derived"]["b_va"]["standard_error"] == b.standard_error);
  CHECK(root["derived"]["lambda_va"]["unit"] == "1");
}

TEST_CASE("what a fixed parameter gives is certain; what nothing estimated gives has no error") {
  CalibrationOptions options = quick_options();
  options.fit.fix["s_va"] = 0.95;
  const Calibration calibration = calibrate_tube(options);
  CHECK(std::isnan(calibration.derived[0].standard_error));
  CHECK(calibration.derived[1].standard_error ==
        doctest::Approx(calibration.fit["c_va"].standard_error / 0.95));
  check_round_trip(calibration);
}

TEST_CASE("the field's strength alone: the truth within its errors, no rotation among them") {
  for (const double noise : {0.05, 0.3, 1.0}) {
    const Calibration calibration = calibrate_strength(noise);
    CHECK(calibration.fit.status == FitStatus::converged);
    check_truth(calibration.fit, simulate_strength(noise).truth);
    CHECK(calibration.fit.n_1 == 0);
    CHECK(calibration.fit.noise[0].value == doctest::Approx(noise).epsilon(0.15));
    CHECK(calibration.fit.identifiability.unobservable.size() == 3);
    CHECK(calibration.fit.message.find("a rotation") != std::string::npos);
    CHECK(calibration.options.fit.samples == 0);
    check_round_trip(calibration);
  }
}

TEST_CASE("the model's noise is that of the fit, or what is given") {
  const Calibration calibration = calibrate_strength(0.8);
  const double noise = calibration.fit.noise[0].value;
  CHECK(calibration.probe->settings().at("field_noise")[0] == doctest::Approx(noise).epsilon(1e-9));
  CalibrationOptions options = quick_options();
  options.fit.noise["field"] = 0.5;
  CHECK(calibrate_strength(0.8, options).probe->settings().at("field_noise")[0] == 0.5);
}

TEST_CASE("stage one is the ellipsoid") {
  const Calibration calibration = calibrate_strength(0.3);
  const StageOne& stage_one = calibration.fit.stage_one;
  CHECK(stage_one.samples.size() == 0);
  REQUIRE(stage_one.best.size() == 9);
  const auto truth = simulate_strength(0.3).truth;
  for (Eigen::Index k = 0; k < 9; ++k) {
    const Parameter& parameter = calibration.fit.parameters[static_cast<std::size_t>(k)];
    // Algebraic: some standard errors off the maximum-likelihood fit, and not a wild start.
    CHECK(std::abs(stage_one.best[k] - truth.at(parameter.name)) < 20 * parameter.standard_error);
    CHECK(stage_one.best[k] != parameter.value);
  }
  const Json root = Json::parse(to_json(calibration));
  CHECK(root["stage_one"]["samples"] == 0);
  CHECK(root["stage_one"]["best"].size() == 9);
  CHECK(root["parameters"].size() == 9);
  CHECK(root["unobservable"][2]["combination"] == "eta_z");
}

TEST_CASE("a record of arrays is calibrated as a flight is") {
  const SimulatedFlight flight = simulate_strength(0.3);
  Record record;
  for (const char* axis : {"x", "y", "z"}) {
    const std::string name = std::string("m") + axis;
    record.add(name, flight.column(name + "_ut"));
  }
  const auto probe = attitude_independent_probe(strength);
  const Calibration arrays =
      calibrate(attitude_independent_probe(strength), record, CalibrationOptions{});
  const Calibration whole = calibrate_strength(0.3);
  CHECK((arrays.fit.values() - whole.fit.values()).norm() < 1e-9);
}

}  // namespace calibration_probes_test
