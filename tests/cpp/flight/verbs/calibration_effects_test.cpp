// SPDX-License-Identifier: BSD-3-Clause
// What BASE.json keeps of effects: centre, knots, labels, span and the time of a step, to the byte;
// and what is refused in their place.
#include <nlohmann/json.hpp>

#include "flights_with_effects.hpp"
#include "sepcal/flight/apply.hpp"
#include "sepcal/flight/comparison.hpp"

namespace calibration_effects_test {

using namespace sepcal;
using namespace sepcal::test;
using Json = nlohmann::ordered_json;
using Texts = std::vector<std::string>;

namespace {

/// Read again it is the same text, the same settings and the same model.
Calibration check_round_trip(const Calibration& calibration, const Flight& flight) {
  const std::string text = to_json(calibration);
  Calibration read = parse_calibration(text, "base.json");
  CHECK(to_json(read) == text);
  CHECK(read.options.effects == calibration.options.effects);
  CHECK(compare(read, flight).residuals == compare(calibration, flight).residuals);
  const auto given = apply(read, flight);
  const auto expected = apply(calibration, flight);
  for (std::size_t j = 0; j < expected.size(); ++j) {
    for (std::size_t row = 0; row < flight.rows(); ++row) {
      const double value = given[j].values[row];
      const bool both_empty = std::isnan(value) && std::isnan(expected[j].values[row]);
      REQUIRE((both_empty || value == expected[j].values[row]));
    }
  }
  return read;
}

Calibration check_round_trip(const char* probe, const Texts& effects) {
  const SimulatedFlight simulated = fly(probe, {}, {.noise = 0.1, .seed = 6});
  const Calibration calibration = calibrate_with(probe, simulated, effects);
  for (const EffectSetting& setting : calibration.options.effects) CHECK(setting.known);
  return check_round_trip(calibration, make_flight(simulated));
}

}  // namespace

TEST_CASE("effects of every kind read back as the same text") {
  check_round_trip("five-hole", {"wind[altitude_m]", "airspeed_scale[alpha^2]", "heading_bias"});
  check_round_trip("five-hole", {"wind[spline(time,5)]", "airspeed_bias[maneuver]", "upwash"});
  check_round_trip("five-hole", {"icing_ramp", "density_error"});
  check_round_trip("pitot-static", {"airspeed_scale[throttle^n]", "wind_shear"});
  check_round_trip("magnetometer", {"bias_step", "bias[temp_degc^2]", "eddy_currents"});
  check_round_trip("magnetometer", {"warm_up", "bias[delay(current_a)]"});
  check_round_trip("magnetometer-norm", {"bias_step", "scale[temp_degc]"});
}

TEST_CASE("what was taken from the record stands beside the effect's name") {
  const SimulatedFlight simulated = fly("five-hole", {}, {.noise = 0.1, .seed = 6});
  const Json root =
      Json::parse(to_json(calibrate_with("five-hole", simulated,
                                         {"wind_shear", "airspeed_bias[spline(time,3)]",
                                          "airspeed_scale[maneuver]", "water_blockage"})));
  const Json& effects = root["options"]["effects"];
  REQUIRE(effects.size() == 4);
  CHECK(effects[0]["name"] == "wind[altitude_m]");
  CHECK(effects[0]["centre"].get<double>() ==
        doctest::Approx(values(simulated, "altitude_m").mean()).epsilon(1e-12));
  const auto& time = simulated.column("time_s");
  CHECK(effects[1]["knots"][0] == time.front());
  // Knots in time are multiples of 2^-22 s.
  CHECK(effects[1]["knots"][2].get<double>() == doctest::Approx(time.back()).epsilon(1e-8));
  CHECK(effects[2]["labels"][0] == simulated.maneuver.front());
  CHECK(effects[3]["span"] == Json{time.front(), time.back()});
  CHECK(effects[3]["t0"] == root["parameters"]["water_blockage.t0"]["value"]);
  CHECK(root["parameters"]["water_blockage.t0"]["standard_error"].is_null());
  CHECK(root["parameters"]["wind[altitude_m].n"]["unit"] == "m/s per m");
}

TEST_CASE("a step's time that was found is held in what was read") {
  const Calibration read = check_round_trip("magnetometer", {"bias_step"});
  CHECK(read.fit["bias_step.t0"].fixed);
  CHECK(!read.fit["bias_step.x"].fixed);
}

TEST_CASE("an effect that stands there in another way is damage") {
  const Json whole = Json::parse(to_json(calibrate_with(
      "five-hole", fly("five-hole", {}, {.noise = 0.1}), {"wind[altitude_m]", "icing_ramp"})));
  for (const auto& [path, value] : {std::pair{"/options/effects", Json("wind[time]")},
                                    {"/options/effects/0", Json("wind[time]")},
                                    {"/options/effects/0/name", Json(3)},
                                    {"/options/effects/0/centre", Json("x")},
                                    {"/options/effects/0/knots", Json(3)},
                                    {"/options/effects/0/labels", Json{1, 2}},
                                    {"/options/effects/1/span", Json{1}},
                                    {"/options/effects/1/t0", Json("x")}}) {
    CAPTURE(std::string(path));
    Json damaged = whole;
    damaged[Json::json_pointer(path)] = value;
    check_refused([&] { parse_calibration(damaged.dump(), "base.json"); },
                  {"base.json is damaged: ", "; fit the flight again"});
  }
}

TEST_CASE("a calibration whose effects and parameters don't belong together is of no use") {
  const SimulatedFlight simulated = fly("five-hole", {}, {.noise = 0.1});
  const Flight flight = make_flight(simulated);
  const Calibration whole =
      calibrate_with("five-hole", simulated, {"airspeed_bias[flap]", "pneumatic_lag"});
  for (const char* parameter : {"airspeed_bias[flap].s", "pneumatic_lag.tau"}) {
    Calibration damaged = whole;
    std::erase_if(damaged.fit.parameters,
                  [&](const Parameter& at) { return at.name == parameter; });
    check_refused([&] { compare(damaged, flight); },
                  {"parameters are not those", "fit the flight"});
    check_refused([&] { apply(damaged, flight); }, {parameter});
  }
  Calibration without = whole;
  without.options.effects.pop_back();
  check_refused([&] { compare(without, flight); }, {"parameters are not those"});
}

TEST_CASE("effects count as parameters where rows are few") {
  const SimulatedFlight simulated = fly("five-hole", {}, {.rows = 12, .noise = 0.1});
  CHECK_NOTHROW(calibrate_with("five-hole", simulated, {"wind[altitude_m]"}));
  check_refused([&] { calibrate_with("five-hole", simulated, {"wind[altitude_m]", "upwash"}); },
                {"12 usable rows", "13 parameters"});
}

TEST_CASE("the same effect twice is refused and named") {
  const SimulatedFlight simulated = fly("five-hole", {}, {.noise = 0.1});
  check_refused([&] { calibrate_with("five-hole", simulated, {"heading_bias", "heading_bias"}); },
                {"heading_bias.delta", "heading_bias"});
  check_refused([&] { calibrate_with("five-hole", simulated, {"wind_shear", "wind[altitude_m]"}); },
                {"wind[altitude_m].n"});
}

}  // namespace calibration_effects_test
