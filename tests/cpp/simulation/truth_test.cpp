// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/simulation/truth.hpp"

#include <nlohmann/json.hpp>

#include "calibrated_flights.hpp"

namespace truth_test {

using namespace sepcal;
using namespace sepcal::test;

TEST_CASE("a truth reads back as it was") {
  FiveHoleTruth probe;
  probe.parameters["eps_phi"] = 0.1 + 0.2;  // no short decimal
  probe.k_alpha = 6.5;
  probe.k_beta = 5.5;
  probe.lever_arm = {0.8, -0.3, 0.2};
  probe.noise = {0.1, 0.2, 0.3};
  const FiveHoleTruth again = parse_five_hole_truth(to_json(probe), "truth.json");
  CHECK(again.parameters == probe.parameters);
  CHECK(again.k_alpha == 6.5);
  CHECK(again.k_beta == 5.5);
  CHECK(again.lever_arm == probe.lever_arm);
  CHECK(again.noise == probe.noise);

  MagnetometerTruth magnetometer;
  magnetometer.parameters["n_y"] = -1.0 / 3.0;
  magnetometer.field = {17.0, 3.0, -45.0};
  magnetometer.noise = {0.2, 0.4, 0.8};
  const MagnetometerTruth second = parse_magnetometer_truth(to_json(magnetometer), "truth.json");
  CHECK(second.parameters == magnetometer.parameters);
  CHECK(second.field == magnetometer.field);
  CHECK(second.noise == magnetometer.noise);
}

TEST_CASE("the JSON has the keys of the interface") {
  const auto probe = nlohmann::ordered_json::parse(to_json(FiveHoleTruth{}));
  CHECK(probe["model"] == "five-hole");
  CHECK(probe["parameters"]["lambda_va"] == 0.05);
  CHECK(probe["options"]["lever_arm"] == std::vector{0.35, 0.0, -0.02});
  CHECK(probe["noise"]["vd"] == 0.15);
  const auto magnetometer = nlohmann::ordered_json::parse(to_json(MagnetometerTruth{}));
  CHECK(magnetometer["model"] == "magnetometer");
  CHECK(magnetometer["options"]["field"] == std::vector{19.7, -1.4, 49.4});
  CHECK(magnetometer["noise"].size() == 3);
}

TEST_CASE("an aircraft's truth reads back as it was, with its geometry") {
  AircraftTruth aircraft;
  aircraft.parameters["CX_alpha^2"] = 1.0 / 3.0;
  aircraft.noise["vd"] = 0.7;
  aircraft.turbulence = 0.4;
  aircraft.geometry.imu = {0.5, 0.0, -0.1};
  aircraft.effects = {{"Cm[alpha^2]"}};
  const AircraftTruth again = parse_aircraft_truth(to_json(aircraft), "truth.json");
  CHECK(again.parameters == aircraft.parameters);
  CHECK(again.noise == aircraft.noise);
  CHECK(again.turbulence == 0.4);
  CHECK(again.geometry.imu == aircraft.geometry.imu);
  CHECK(again.effects.front().name == "Cm[alpha^2]");
  check_refused([] { parse_aircraft_truth(R"({"noise": {"mx": 1}})", "t.json"); },
                {"t.json", "there is no output 'mx'"});
  check_refused([] { parse_aircraft_truth(R"({"aircraft": {"area_m2": -1}})", "t.json"); },
                {"t.json", "aircraft: chord_m is missing"});
}

TEST_CASE("a tube's truth reads back as it was") {
  PitotStaticTruth tube;
  tube.parameters["s_va"] = 1.0 / 3.0;
  tube.noise = {0.7};
  const PitotStaticTruth again = parse_pitot_static_truth(to_json(tube), "truth.json");
  CHECK(again.parameters == tube.parameters);
  CHECK(again.noise == tube.noise);
  const auto json = nlohmann::ordered_json::parse(to_json(PitotStaticTruth{}));
  CHECK(json["model"] == "pitot-static");
  CHECK(json["noise"]["airspeed"] == 0.3);
  CHECK_FALSE(json.contains("effects"));
  check_refused([] { parse_pitot_static_truth(R"({"model": "five-hole"})", "t.json"); },
                {"t.json", "five-hole", "--probe"});
  check_refused([] { parse_pitot_static_truth(R"({"noise": {"vn": 1}})", "t.json"); },
                {"'vn'", "airspeed"});
  check_refused([] { parse_pitot_static_truth(R"({"options": {"k_alpha": 1}})", "t.json"); },
                {"'k_alpha'"});
}

TEST_CASE("a truth with hidden effects flies the same flight again") {
  const auto check = [](auto truth, auto simulate, auto parse,
                        const std::vector<SizedEffect>& effects) {
    const SimulatedFlight flight = simulate(hiding(truth, effects), condensed(60, 3));
    const std::string json = to_json(as_flown(truth, flight));
    const auto written = nlohmann::ordered_json::parse(json);
    CHECK(written["effects"].size() == effects.size());
    const SimulatedFlight again = simulate(parse(json, "truth.json"), condensed(60, 3));
    CHECK(again.truth == flight.truth);
    CHECK(again.effects == flight.effects);
    for (const SimulatedColumn& column : flight.columns) {
      CHECK(again.column(column.name) == column.values);
    }
    CHECK(to_json(as_flown(truth, again)) == json);
  };
  check(FiveHoleTruth{}, sepcal::simulate_five_hole, parse_five_hole_truth,
        {{"wind_shear", {0.01, -0.02}}, {"icing_ramp", {-1e-4}}, {"wind[maneuver]", {0.5}}});
  check(PitotStaticTruth{}, sepcal::simulate_pitot_static, parse_pitot_static_truth,
        {{"wind[spline(time,4)]", {1, 2, 3, 4, 5, 6}}, {"pneumatic_lag", {0.2}}});
  check(MagnetometerTruth{}, sepcal::simulate_magnetometer, parse_magnetometer_truth,
        {{"bias[throttle^n]", {1, 2, 3, 1.5}}, {"warm_up", {4}}, {"eddy_currents", {0.01}}});
}

TEST_CASE("a hidden effect can be written by hand") {
  const char* json = R"({"parameters": {"bias[time].x": 0.1, "bias[time].y": 0, "bias[time].z": 0,
                         "bias_step.x": 1, "bias_step.y": 2, "bias_step.z": 3},
                         "effects": ["bias_step"]})";
  const SimulatedFlight flight =
      simulate_magnetometer(parse_magnetometer_truth(json, "t.json"), condensed(30));
  CHECK(flight.effects == std::vector<std::string>{"bias_step", "bias[time]"});
  CHECK(flight.truth.at("bias[time].x") == 0.1);
  CHECK(flight.truth.at("bias_step.t0") == doctest::Approx(80.0 / 3 * 29 / 30));
  const auto refuse = [](const char* text, std::initializer_list<std::string_view> words) {
    CAPTURE(std::string(text));
    check_refused(
        [&] { simulate_magnetometer(parse_magnetometer_truth(text, "t.json"), condensed(30)); },
        words);
  };
  refuse(R"({"effects": ["bias[time]"]})", {"t.json: ", "'bias[time].x' is missing"});
  refuse(R"({"effects": ["gusts"]})", {"t.json: ", "'gusts'", "bias[DRIVER]"});
  refuse(R"({"parameters": {"gusts.x": 1}})", {"t.json: ", "'gusts'"});
  refuse(R"({"parameters": {"bias_step.x": 1, "bias_step.y": 1, "bias_step.z": 1,
          "bias_step.w": 1}})",
         {"t.json: ", "'bias_step.w'"});
  refuse(R"({"effects": "bias[time]"})", {"t.json: "});
  refuse(R"({"effects": [3]})", {"t.json: "});
}

TEST_CASE("a field can be given by its strength") {
  const MagnetometerTruth truth =
      parse_magnetometer_truth(R"({"options": {"field_strength": 48}})", "t.json");
  CHECK(Vector3d(truth.field.data()).norm() == doctest::Approx(48).epsilon(1e-14));
  CHECK(Vector3d(truth.field.data()).normalized().dot(Vector3d(19.7, -1.4, 49.4).normalized()) ==
        doctest::Approx(1).epsilon(1e-14));
}

TEST_CASE("what a file leaves out keeps its default") {
  CHECK(to_json(parse_five_hole_truth("{}", "t")) == to_json(FiveHoleTruth{}));
  CHECK(to_json(parse_magnetometer_truth("{}", "t")) == to_json(MagnetometerTruth{}));
  FiveHoleTruth changed;
  changed.parameters["w_n"] = 7;
  changed.k_beta = 5;
  changed.noise[1] = 0;
  CHECK(to_json(parse_five_hole_truth(
            R"({"parameters": {"w_n": 7}, "options": {"k_beta": 5}, "noise": {"ve": 0}})", "t")) ==
        to_json(changed));
}

TEST_CASE("a value that can't be flown names the file that it stood in") {
  for (const char* json :
       {R"({"parameters": {"lambda_va": -2}})", R"({"options": {"k_alpha": -1}})",
        R"({"noise": {"vn": -0.1}})", R"({"parameters": {"b_va": 300}})"}) {
    CAPTURE(std::string(json));
    check_refused([&] { simulate_five_hole(parse_five_hole_truth(json, "t.json"), condensed(5)); },
                  {"t.json: "});
  }
}

TEST_CASE("what is no truth is refused, opened by its source") {
  const auto check = [](const char* json, std::initializer_list<std::string_view> words) {
    CAPTURE(std::string(json));
    check_refused([&] { parse_five_hole_truth(json, "truth.json"); }, words);
    check_refused([&] { parse_five_hole_truth(json, "truth.json"); }, {"truth.json"});
  };
  for (const char* text : {"", "w_n = 3", "[]", "3", "{\"parameters\": {", "\xFF"}) {
    check(text, {"truth.json is not a truth file", "{\"parameters\": {name: value}}"});
  }
  check(R"({"model": "magnetometer"})", {"magnetometer", "other app"});
  check(R"({"params": {}})", {"'params' is unknown", "parameters, options, noise, effects"});
  check(R"({"parameters": {"w_up": 1}})", {"'w_up'", "the model has: b_alpha, "});
  check(R"({"parameters": {"w_n": "strong"}})", {"simulate --truth"});
  check(R"({"parameters": {"w_n": null}})", {"simulate --truth"});
  check(R"({"parameters": [1, 2]})", {"truth.json"});
  check(R"({"options": {"k_alpha": "high"}})", {"simulate --truth"});
  check(R"({"options": {"lever_arm": [1, 2]}})", {"simulate --truth"});
  check(R"({"options": {"field": [1, 2, 3]}})", {"'field'", "lever_arm"});
  check(R"({"options": {"lever_arm": [1, 2, 3, 4]}})", {"lever_arm"});
  check(R"({"noise": {"mx": 1}})", {"'mx'", "vn, ve, vd"});
  check_refused([] { parse_magnetometer_truth(R"({"model": "five-hole"})", "t.json"); },
                {"t.json", "five-hole", "other app"});
  check_refused([] { parse_magnetometer_truth(R"({"parameters": {"w_n": 1}})", "t.json"); },
                {"t.json", "'w_n'", "alpha_xy"});
  check_refused([] { parse_magnetometer_truth(R"({"noise": {"vn": 1}})", "t.json"); },
                {"t.json", "'vn'", "mx, my, mz"});
}

}  // namespace truth_test
