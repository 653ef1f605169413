// SPDX-License-Identifier: BSD-3-Clause
// Intervals and predictions of calibrations: with effects, with steps, of a probe whose model needs
// its own noise, and as JSON.
#include "sepcal/flight/intervals.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "calibrated_flights.hpp"

namespace intervals_test {

using namespace sepcal;
using namespace sepcal::test;
using Json = nlohmann::ordered_json;

namespace {

CalibrationOptions quick_options() {
  CalibrationOptions options;
  options.fit.samples = 40;
  options.fit.threads = 1;
  return options;
}

/// Within a fifth of the Gaussian one's half.
void check_near_gaussian(const ProfileInterval& interval) {
  CAPTURE(interval.name);
  const double half = interval.gaussian.upper - interval.value;
  CHECK(interval.profile.lower == doctest::Approx(interval.gaussian.lower).epsilon(0.2 * half));
  CHECK(std::abs(interval.profile.lower - interval.gaussian.lower) < 0.2 * half);
  CHECK(std::abs(interval.profile.upper - interval.gaussian.upper) < 0.2 * half);
  CHECK(interval.lower_end == IntervalEnd::crossed);
  CHECK(interval.upper_end == IntervalEnd::crossed);
}

}  // namespace

TEST_CASE("a five-hole calibration with an effect") {
  CalibrationOptions options = quick_options();
  options.effects = {{.name = "wind[altitude_m]"}};
  const Flight flight = make_flight(simulate_five_hole({}, condensed(400)));
  const Calibration base = calibrate(make_five_hole(), flight, options);
  const FlightIntervals intervals = find_intervals(base, flight, {.level = 0.9});
  CHECK(intervals.parameters.size() == 12);
  for (const ProfileInterval& interval : intervals.parameters) check_near_gaussian(interval);

  const Json json = Json::parse(to_json(intervals));
  CHECK(json["level"] == 0.9);
  CHECK(json["model"] == "five-hole");
  CHECK(json["inputs"]["rows_used"] == 400);
  CHECK(json["parameters"]["b_va"]["ends"] == Json::array({"crossed", "crossed"}));
  CHECK(json["parameters"]["b_va"]["profile"][0] == intervals.parameters[1].profile.lower);
}

TEST_CASE("a magnetometer of which only the field's strength is known keeps the fit's noise") {
  const Flight flight = make_flight(simulate_magnetometer({}, condensed(400)));
  CalibrationOptions options = quick_options();
  options.fit.samples = FitOptions{}.samples;  // it samples none
  const Calibration base = calibrate(attitude_independent_probe(53.2), flight, options);
  const FlightIntervals intervals = find_intervals(base, flight, {.names = {"n_x", "lambda_x"}});
  REQUIRE(intervals.parameters.size() == 2);
  for (const ProfileInterval& interval : intervals.parameters) check_near_gaussian(interval);
}

TEST_CASE("what a tube holds has no interval") {
  const Flight flight = make_flight(simulate_pitot_static({}, condensed(400)));
  const Calibration base = calibrate(pitot_static_probe(), flight, quick_options());
  for (const ProfileInterval& interval : find_intervals(base, flight).parameters) {
    CHECK(interval.name != "w_d");
  }
}

TEST_CASE("a calibration that was read predicts as the one that was written") {
  const Flight flight = make_flight(simulate_five_hole({}, condensed(200)));
  const Calibration base = calibrate(make_five_hole(), flight, quick_options());
  const Calibration read = parse_calibration(to_json(base), "base.json");
  const FlightPrediction expected = predict(base, flight);
  const FlightPrediction prediction = predict(read, flight);
  CHECK(prediction.time.size() == 200);
  CHECK(prediction.prediction.value == expected.prediction.value);
  CHECK(prediction.prediction.standard_error.isApprox(expected.prediction.standard_error, 1e-12));
  CHECK(to_json(find_intervals(read, flight)) == to_json(find_intervals(base, flight)));
}

}  // namespace intervals_test
