// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/truth.hpp"

#include <nlohmann/json.hpp>

#include "calibrated_flights.hpp"

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
  check(R"({"params": {}})", {"'params' is unknown", "parameters, options, noise"});
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
