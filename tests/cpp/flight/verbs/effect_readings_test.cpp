// SPDX-License-Identifier: BSD-3-Clause
// Effects hidden by the simulator, added to the fit and undone in the readings: the truth comes
// back, residuals are noise, and corrected columns are what a perfect sensor reads.
#include "flight/verbs/effect_readings.hpp"

#include <cmath>

#include "flights_with_effects.hpp"
#include "sepcal/detail/natural_spline.hpp"
#include "sepcal/flight/apply.hpp"
#include "sepcal/flight/comparison.hpp"

namespace effect_readings_test {

using namespace sepcal;
using namespace sepcal::test;

namespace {

struct Hidden {
  const char* probe;
  SizedEffect effect;
};

/// What the hidden effect adds to the wind in the mean, if it is a spline of time: the simulator's
/// w_n is the wind at the first knot, the fit's that of the flight.
double mean_of_spline(const SimulatedFlight& flight, const std::string& parameter) {
  constexpr int knots = 6;
  std::vector<double> heights{0.0};
  for (int j = 2; j <= knots; ++j) {
    const auto height =
        flight.truth.find("wind[spline(time,6)]." + parameter.substr(2) + "_" + std::to_string(j));
    if (!parameter.starts_with("w_") || height == flight.truth.end()) return 0.0;
    heights.push_back(height->second);
  }
  const auto& time = flight.column("time_s");
  const NaturalSpline spline(even_knots(time.front(), time.back(), knots), heights);
  double sum = 0.0;
  for (const double t : time) sum += spline.at(t).value;
  return sum / static_cast<double>(time.size());
}

/// Every estimate but a step's time is within six standard errors of the truth: among a thousand
/// normal ones, less than once in 10^5 runs; the seed is fixed.
void check_truth(const Calibration& calibration, const SimulatedFlight& flight) {
  for (const Parameter& parameter : calibration.fit.parameters) {
    const auto truth = flight.truth.find(parameter.name);
    REQUIRE(truth != flight.truth.end());
    if (parameter.fixed) continue;
    CAPTURE(parameter.name);
    const double expected = truth->second + mean_of_spline(flight, parameter.name);
    CHECK(std::abs(parameter.value - expected) < 6.0 * parameter.standard_error);
  }
}

/// An rmse of n values is off by 1 / sqrt(2 n) of itself; a fifth is 5.6 times that for 400.
void check_noise(const Calibration& calibration, const Flight& flight, double noise) {
  for (const Misfit& misfit : compare(calibration, flight).overall) {
    CHECK(std::abs(misfit.rmse / noise - 1.0) < 0.2);
  }
}

/// Corrected columns are within `tolerance` of what a perfect sensor reads, or empty in a hundredth
/// of the rows at most.
void check_corrected(const Hidden& hidden, const Calibration& calibration, const Flight& flight,
                     const Conditions& conditions, double tolerance) {
  const auto columns = apply(calibration, flight);
  const auto truth = true_readings(hidden.probe, {hidden.effect}, conditions);
  REQUIRE(columns.size() == truth.size());
  for (std::size_t j = 0; j < columns.size(); ++j) {
    CAPTURE(columns[j].header);
    std::size_t empty = 0;
    double worst = 0.0;
    for (std::size_t row = 0; row < conditions.rows; ++row) {
      const double value = columns[j].values[row];
      if (std::isnan(value)) ++empty;
      if (!std::isnan(value)) {
        worst = std::max(worst, std::abs(value - truth[j][static_cast<Eigen::Index>(row)]));
      }
    }
    CHECK(worst < tolerance);
    CHECK(empty <= conditions.rows / 100);
  }
}

/// Without the effect the residuals are well above the noise; with it all is as it should be.
void check_hidden(const Hidden& hidden, const Conditions& conditions, double tolerance) {
  CAPTURE(hidden.probe);
  CAPTURE(hidden.effect.name);
  const SimulatedFlight simulated = fly(hidden.probe, {hidden.effect}, conditions);
  const Flight flight = make_flight(simulated);
  double without = 0.0;
  for (const OutputValue& rmse : calibrate_with(hidden.probe, simulated, {}).fit.rmse) {
    without = std::max(without, rmse.value);
  }
  CHECK(without > 3.0 * conditions.noise);
  const Calibration calibration = calibrate_with(hidden.probe, simulated, {hidden.effect.name});
  CHECK(calibration.fit.status == FitStatus::converged);
  check_truth(calibration, simulated);
  check_noise(calibration, flight, conditions.noise);
  check_corrected(hidden, calibration, flight, conditions, tolerance);
}

}  // namespace

TEST_CASE("a five-hole probe's effects are found and undone") {
  // The pressures are exact, so that only the estimates' errors are left: of 400 rows, well below
  // one standard deviation of the noise.
  constexpr double noise = 1e-6;
  for (const SizedEffect& effect : {SizedEffect{"wind[altitude_m]", {0.01, -0.02}},
                                    {"wind[maneuver]", {0.5}},
                                    {"wind[spline(time,6)]", {1.0}},
                                    {"airspeed_scale[alpha^2]", {-0.8}},
                                    {"airspeed_scale[throttle^n]", {0.05}},
                                    {"airspeed_bias[flap]", {0.7}},
                                    {"airspeed_bias[maneuver]", {0.4}},
                                    {"pressure_offset[throttle]", {20.0}},
                                    {"pressure_offset[temp_k]", {5.0}},
                                    {"alpha_offset[q]", {0.05}},
                                    {"beta_offset[r]", {0.05}},
                                    {"heading_bias", {0.03}},
                                    {"lever_arm", {0.1, 0.2, -0.3}},
                                    {"density_error", {5.0}},
                                    {"compressibility", {1.0}},
                                    {"upwash", {0.4}},
                                    {"sidewash", {0.3}},
                                    {"water_blockage", {-0.1}}}) {
    check_hidden({"five-hole", effect}, {.noise = noise, .seed = 3}, noise);
  }
}

TEST_CASE("a pitot-static tube's effects are found and undone") {
  // The reading's own noise stays in it, divided by s_va: 400 values beyond six standard deviations
  // are less than 1 in 10^6.
  constexpr double noise = 1e-6;
  for (const SizedEffect& effect : {SizedEffect{"wind[time]", {0.02, -0.03}},
                                    {"wind[altitude_m^2]", {0.001}},
                                    {"airspeed_scale[throttle]", {0.05}},
                                    {"airspeed_bias[current_a]", {0.05}},
                                    {"pressure_offset[throttle]", {20.0}},
                                    {"density_error", {5.0}},
                                    {"water_blockage", {-0.1}}}) {
    check_hidden({"pitot-static", effect}, {.noise = noise, .seed = 3}, 6.5 * noise);
  }
}

TEST_CASE("a magnetometer's effects are found and undone, without an attitude as well") {
  constexpr double noise = 1e-6;
  for (const SizedEffect& effect : {SizedEffect{"bias[current_a]", {0.2, -0.1, 0.3}},
                                    {"bias[throttle^n]", {2, -1, 3}},
                                    {"bias[temp_degc^2]", {0.01, 0.02, -0.01}},
                                    {"scale[temp_degc]", {0.001}},
                                    {"axis_scale[current_a]", {0.001, -0.002, 0.003}},
                                    {"bias_step", {2, -1, 3}},
                                    {"warm_up", {2, -1, 3}}}) {
    check_hidden({"magnetometer", effect}, {.noise = noise, .seed = 3}, 6.5 * noise);
    check_hidden({"magnetometer-norm", effect}, {.noise = noise, .seed = 3}, 6.5 * noise);
  }
  for (const SizedEffect& effect :
       {SizedEffect{"cubic_nonlinearity", {1e-6, -2e-6, 3e-6, 1e-4, 2e-4, -1e-4}},
        {"eddy_currents", {0.01, -0.02, 0.03, 0.02, 0.01, -0.01, 0.015, 0.005, -0.03}},
        {"field_declination", {0.05}}}) {
    check_hidden({"magnetometer", effect}, {.noise = noise, .seed = 3}, 6.5 * noise);
  }
}

TEST_CASE("a ramp is found and undone, but for its corner") {
  // The fit's corner is rounded over +-0.6 s, the truth's is sharp: off by 0.15 s times 0.001 / s
  // of the airspeed, 4e-3 m/s, where it is worst.
  constexpr double noise = 1e-2;
  const SizedEffect ramp{"icing_ramp", {-0.001}};
  check_hidden({"five-hole", ramp}, {.noise = noise, .seed = 3}, noise);
  check_hidden({"pitot-static", ramp}, {.noise = noise, .seed = 3}, 6.5 * noise);
}

TEST_CASE("effects in time are found and undone") {
  // Twenty rows a second are interpolated: natural splines are off by up to 4e-4 at segments' ends
  // in air data and 5e-3 in a field that turns, and undoing a lag of a row multiplies noise by 2.5.
  constexpr double noise = 1e-3;
  const Conditions air{.rows = 2400, .noise = noise, .seed = 3};
  check_hidden({"five-hole", {"time_offset", {0.08}}}, air, noise);
  check_hidden({"five-hole", {"pneumatic_lag", {0.06}}}, air, noise);
  check_hidden({"pitot-static", {"time_offset", {0.1}}}, air, 7 * noise);
  check_hidden({"pitot-static", {"pneumatic_lag", {0.05}}}, air, 15 * noise);
  const Conditions turning{.rows = 1600, .noise = noise, .seed = 3};
  check_hidden({"magnetometer", {"bias[delay(current_a)]", {0.2, -0.1, 0.3}}}, turning, 7 * noise);
  check_hidden({"magnetometer", {"time_offset", {0.05}}}, turning, 7 * noise);
  check_hidden({"magnetometer", {"sensor_lag", {0.05}}}, turning, 20 * noise);
}

}  // namespace effect_readings_test
