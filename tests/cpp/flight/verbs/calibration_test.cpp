// SPDX-License-Identifier: BSD-3-Clause
// BASE.json there and back, whatever the fit came to, and what is refused in its place.
#include "sepcal/flight/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "calibrated_flights.hpp"
#include "temporary_folder.hpp"

namespace calibration_test {

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

Calibration calibrate_five_hole(const CalibrationOptions& options = quick_options()) {
  return calibrate(make_five_hole(), make_flight(simulate_five_hole({}, condensed(200))), options);
}

Calibration calibrate_magnetometer() {
  return calibrate(magnetometer_probe({{19.7, -1.4, 49.4}}),
                   make_flight(simulate_magnetometer({}, condensed(200))), quick_options());
}

/// Every row is the first one but for its time: nothing but a combination or two is determined.
Calibration calibrate_frozen_flight() {
  SimulatedFlight frozen = simulate_five_hole({}, condensed(200));
  for (SimulatedColumn& column : frozen.columns) {
    if (column.name == "time_s" || column.name.starts_with('v')) continue;
    std::ranges::fill(column.values, column.values.front());
  }
  return calibrate(make_five_hole(), make_flight(frozen), quick_options());
}

/// The text once it was read is the text that was written.
void check_round_trip(const Calibration& calibration) {
  const std::string text = to_json(calibration);
  CHECK(to_json(parse_calibration(text, "base.json")) == text);
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  const std::size_t found = text.find(from);
  REQUIRE(found != std::string::npos);
  return text.replace(found, from.size(), to);
}

/// A calibration as the schema before the present one had it.
std::string as_version_2(const std::string& now) {
  std::string before = replaced(now, "\"schema_version\": 3", "\"schema_version\": 2");
  before = replaced(before, "\"stage_one_segments\"", "\"stage_one\"");
  before = replaced(before, "\"stage_two_segments\"", "\"stage_two\"");
  return replaced(before, "\"second_stage\": \"projected\"", "\"method\": \"projected\"");
}

}  // namespace

TEST_CASE("a calibration reads back as the same text") {
  check_round_trip(calibrate_five_hole());
  check_round_trip(calibrate_magnetometer());
}

TEST_CASE("so it does with every option set") {
  CalibrationOptions options = quick_options();
  options.log.drop_invalid = true;
  options.free = {"w_d"};
  options.fit.fix = {{"w_n", -3.8}, {"eps_phi", 0.05}};
  options.fit.bounds = {{"b_va", {0.0, infinity}}, {"w_e", {-infinity, 30.0}}, {"b_beta", {-1, 1}}};
  options.fit.noise = {{"vn", 0.1}, {"ve", 0.15}, {"vd", 0.2}};
  options.fit.prior = {{"lambda_va", {0.1, 0.2}}, {"b_alpha", {0.01, 0.02}}};
  options.fit.sampling_distribution = {{"b_alpha", {-0.01, 0.05}}};
  options.fit.stage_one_segments = "popu,multisine_1";
  options.fit.stage_two_segments = "wind_circle_1,popu,10:110.5";
  options.fit.sampling = Sampling::low_discrepancy;
  options.fit.seed = ~std::uint64_t{0};
  options.fit.second_stage = SecondStage::joint;
  options.fit.descents = 3;
  options.fit.noise_tolerance = 1e-7;
  options.fit.noise_iterations = 50;
  options.fit.iterations = 150;
  SUBCASE("uniform") { options.fit.sampling = Sampling::uniform; }
  SUBCASE("low discrepancy") { options.fit.sampling_distribution.clear(); }
  const Calibration calibration = calibrate_five_hole(options);
  check_round_trip(calibration);

  const Calibration again = parse_calibration(to_json(calibration), "base.json");
  CHECK(again.options.log.drop_invalid);
  CHECK(again.options.free == options.free);
  CHECK(again.options.fit.fix == options.fit.fix);
  CHECK(again.options.fit.bounds.at("b_va").lower == 0.0);
  CHECK(again.options.fit.bounds.at("b_va").upper == infinity);
  CHECK(again.options.fit.bounds.at("w_e").lower == -infinity);
  CHECK(again.options.fit.noise == options.fit.noise);
  CHECK(again.options.fit.prior.at("lambda_va").mean == 0.1);
  CHECK(again.options.fit.prior.at("lambda_va").standard_deviation == 0.2);
  CHECK(again.options.fit.prior.at("b_alpha").mean == 0.01);
  CHECK(again.options.fit.seed == options.fit.seed);
  CHECK(again.fit["w_n"].fixed);
  CHECK(!again.fit["w_e"].fixed);
  CHECK(std::isnan(again.fit["w_n"].standard_error));
}

TEST_CASE("so it does where a bound is active") {
  CalibrationOptions options = quick_options();
  options.fit.bounds = {{"lambda_alpha", {-0.5, 0.0}}, {"w_e", {0.0, 1.0}}};
  const Calibration calibration = calibrate_five_hole(options);
  REQUIRE(calibration.fit["lambda_alpha"].at_bound);
  REQUIRE(calibration.fit["w_e"].at_bound);
  check_round_trip(calibration);
  CHECK(parse_calibration(to_json(calibration), "base.json").fit["w_e"].at_bound);
}

TEST_CASE("so it does where next to nothing was determined; what is not finite is null") {
  const Calibration calibration = calibrate_frozen_flight();
  REQUIRE(calibration.fit.status == FitStatus::not_identifiable);
  check_round_trip(calibration);
  const Json root = Json::parse(to_json(calibration));
  CHECK(root["status"] == "not_identifiable");
  CHECK(!root["unobservable"].empty());
  CHECK(root["parameters"]["lambda_va"]["standard_error"].is_null());
  CHECK(root["parameters"]["b_va"]["lower"].is_null());
  CHECK(parse_calibration(to_json(calibration), "base.json").fit["b_va"].lower == -infinity);
}

TEST_CASE("so it does where the fit did not converge") {
  CalibrationOptions options = quick_options();
  options.fit.samples = 0;
  options.fit.iterations = 1;
  options.fit.noise_iterations = 1;
  const Calibration calibration = calibrate_five_hole(options);
  REQUIRE(calibration.fit.status == FitStatus::not_converged);
  CHECK(!calibration.fit.message.empty());
  check_round_trip(calibration);
}

TEST_CASE("what was read holds the fit") {
  const Calibration calibration = calibrate_five_hole();
  const Calibration again = parse_calibration(to_json(calibration), "base.json", "sepcal-pitot");
  CHECK(again.probe->name() == "five-hole");
  CHECK(again.probe->settings() == calibration.probe->settings());
  CHECK(again.fit.values() == calibration.fit.values());
  CHECK(again.fit.n_1 == 5);
  CHECK(again.fit.correlation == calibration.fit.correlation);
  CHECK((again.fit.covariance - calibration.fit.covariance).norm() <
        1e-12 * calibration.fit.covariance.norm());
  CHECK(again.fit.rows == 200);
  CHECK(again.flight.rows == 200);
  CHECK(again.fit.cost == calibration.fit.cost);
  CHECK(again.fit.second_stage == calibration.fit.second_stage);
  CHECK(again.fit.stage_one.unique_minimum);
}

TEST_CASE("names that JSON has to escape come back") {
  Calibration calibration = calibrate_five_hole();
  calibration.flight.file = "a \"quoted\"\\path\n\xC3\xA9.csv";
  check_round_trip(calibration);
  const std::string text = to_json(calibration);
  CHECK(parse_calibration(text, "base.json").flight.file == calibration.flight.file);
  calibration.flight.file = "latin \xE9.csv";  // no UTF-8: replaced, but still JSON
  CHECK(Json::accept(to_json(calibration)));
}

TEST_CASE("a calibration of another app or schema is refused") {
  const std::string text = to_json(calibrate_magnetometer());
  CHECK_NOTHROW(parse_calibration(text, "mag.json"));
  CHECK_NOTHROW(parse_calibration(text, "mag.json", "sepcal-mag"));
  check_refused([&] { parse_calibration(text, "mag.json", "sepcal-pitot"); },
                {"mag.json", "magnetometer", "use sepcal-mag"});
  const std::string key = "\"schema_version\": 3";
  for (const char* version : {"0", "4", "-1", "2.5", "\"2\"", "null"}) {
    const std::string other = replaced(text, key, std::string("\"schema_version\": ") + version);
    check_refused([&] { parse_calibration(other, "mag.json"); },
                  {"mag.json", version, "reads 1 to 3", "fit the flight again"});
  }
  const std::string unknown =
      replaced(text, "\"model\": \"magnetometer\"", "\"model\": \"venturi\"");
  check_refused([&] { parse_calibration(unknown, "mag.json"); }, {"mag.json", "'venturi'"});
}

TEST_CASE("a later schema asks for a later sepcal") {
  const std::string later =
      replaced(to_json(calibrate_magnetometer()), "\"schema_version\": 3", "\"schema_version\": 4");
  check_refused([&] { parse_calibration(later, "mag.json"); },
                {"mag.json", "version 4", "update sepcal or fit the flight again"});
}

TEST_CASE("version 1 is read: its priors drew samples, and its knowledge was the prior") {
  CalibrationOptions options = quick_options();
  options.fit.prior = {{"lambda_va", {0.1, 0.2}}, {"b_alpha", {0.01, 0.02}}};
  options.fit.sampling_distribution = {{"b_alpha", {-0.01, 0.05}}};
  const std::string now = to_json(calibrate_five_hole(options));
  // Only these words differ, and where they stand.
  std::string before =
      replaced(as_version_2(now), "\"schema_version\": 2", "\"schema_version\": 1");
  before = replaced(before, "\"prior\": {", "\"knowledge\": {");
  before = replaced(before, "\"sampling_distribution\": {", "\"priors\": {");
  const Calibration read = parse_calibration(before, "base.json");
  CHECK(read.options.fit.prior.size() == 2);
  CHECK(read.options.fit.prior.at("b_alpha").mean == 0.01);
  CHECK(read.options.fit.prior.at("b_alpha").standard_deviation == 0.02);
  CHECK(read.options.fit.sampling_distribution.size() == 1);
  CHECK(read.options.fit.sampling_distribution.at("b_alpha").mean == -0.01);
  CHECK(read.options.fit.sampling_distribution.at("b_alpha").standard_deviation == 0.05);
  CHECK(to_json(read) == now);

  for (const char* key : {"priors", "knowledge"}) {
    CAPTURE(key);
    Json damaged = Json::parse(before);
    damaged["options"].erase(key);
    check_refused([&] { parse_calibration(damaged.dump(), "base.json"); },
                  {"base.json is damaged", "fit the flight again"});
  }
}

TEST_CASE("the first files of version 1 lack what was not to be chosen yet") {
  Json first = Json::parse(as_version_2(to_json(calibrate_five_hole())));
  first["schema_version"] = 1;
  first["options"]["priors"] = Json::object();
  for (const char* key :
       {"sampling_distribution", "prior", "search", "jacobian", "loss", "loss_width"}) {
    first["options"].erase(key);
  }
  const Calibration read = parse_calibration(first.dump(), "base.json");
  CHECK(read.options.fit.prior.empty());
  CHECK(read.options.fit.search == sepcal::Search::sampling);
  CHECK(read.options.fit.jacobian == sepcal::ProjectedJacobian::kaufman);
  CHECK(read.options.fit.loss == sepcal::Loss::squares);
  CHECK(read.options.fit.loss_width == 0.0);
}

TEST_CASE("what is no calibration is refused") {
  for (const char* text : {"", "time_s,vn_mps", "[]", "{}", "null", "{\"schema_version\": 1}"}) {
    CAPTURE(text);
    check_refused([&] { parse_calibration(text, "base.json"); },
                  {"base.json is not a calibration", "fit wrote with -o"});
  }
  const std::string text = to_json(calibrate_five_hole());
  for (const std::size_t length : {text.size() / 4, text.size() / 2, text.size() - 2}) {
    check_refused([&] { parse_calibration(text.substr(0, length), "base.json"); },
                  {"base.json is not a calibration"});
  }
}

TEST_CASE("a calibration with any entry missing or of another kind is refused") {
  const Json whole = Json::parse(to_json(calibrate_five_hole()));
  const auto check_damaged = [&](const Json& damaged) {
    check_refused([&] { parse_calibration(damaged.dump(), "base.json"); }, {"base.json"});
  };
  for (const auto& [key, value] : whole.items()) {
    if (key == "derived" || key == "history") continue;  // always empty so far, never read
    if (key == "collinearity") continue;                 // follows from the covariance, never read
    CAPTURE(key);
    Json damaged = whole;
    damaged.erase(key);
    if (key != "restated") check_damaged(damaged);  // earlier files have none
    damaged[key] = value.is_number() ? Json("text") : Json(3);
    check_damaged(damaged);
  }
  for (const char* group : {"inputs", "options", "stage_one", "stage_two", "correlation"}) {
    for (const auto& [key, value] : whole[group].items()) {
      const bool unread = key == "effects" || key == "names" ||
                          (std::string_view(group) == "stage_one" && key == "samples");
      if (unread) continue;
      CAPTURE(group);
      CAPTURE(key);
      Json damaged = whole;
      damaged[group].erase(key);
      check_damaged(damaged);
      damaged[group][key] = value.is_string() ? Json(3) : Json("text");
      check_damaged(damaged);
    }
  }
  for (const auto& [key, value] : whole["parameters"]["w_n"].items()) {
    CAPTURE(key);
    Json damaged = whole;
    damaged["parameters"]["w_n"].erase(key);
    if (key == "standard_error_noise_model" || key == "standard_error_blocks") {
      // Calibrations of before have none.
      const Calibration read = parse_calibration(damaged.dump(), "base.json");
      const sepcal::Parameter& wind = read.fit["w_n"];
      CHECK(std::isnan(key == "standard_error_blocks" ? wind.standard_error_blocks
                                                      : wind.standard_error_noise_model));
    } else {
      check_damaged(damaged);
    }
  }
  Json damaged = whole;
  damaged["parameters"]["w_n"]["value"] = nullptr;
  check_damaged(damaged);
}

TEST_CASE("choices that are spelt wrong are refused") {
  const std::string text = to_json(calibrate_five_hole());
  for (const auto& [from, to] :
       {std::pair{"\"status\": \"converged\"", "\"status\": \"fine\""},
        {"\"second_stage\": \"auto\"", "\"second_stage\": \"both\""},
        {"\"sampling\": \"uniform\"", "\"sampling\": \"grid\""},
        {"\"second_stage\": \"projected\"", "\"second_stage\": \"guess\""}}) {
    CAPTURE(std::string(to));
    check_refused([&] { parse_calibration(replaced(text, from, to), "base.json"); }, {"base.json"});
  }
}

TEST_CASE("values that no fit writes are damage") {
  const Json whole = Json::parse(to_json(calibrate_five_hole()));
  const auto square = [](std::size_t n) { return Json(std::vector(n, std::vector(n, 1.0))); };
  for (const auto& [path, value] : {std::pair{"/rmse", Json(3)},
                                    {"/noise", Json{{"mx", 1.0}}},
                                    {"/options", Json::array()},
                                    {"/options/samples", Json(5.5)},
                                    {"/options/seed", Json(-1)},
                                    {"/options/threads", Json(1e10)},
                                    {"/options/bounds", Json::array()},
                                    {"/unobservable", Json(nullptr)},
                                    {"/stage_one/minima", Json(nullptr)},
                                    {"/correlation/matrix", square(0)},
                                    {"/correlation/matrix", square(2)},
                                    {"/correlation/matrix", square(11)},
                                    {"/correlation/matrix/3", Json::array()}}) {
    CAPTURE(std::string(path));
    Json damaged = whole;
    damaged[Json::json_pointer(path)] = value;
    check_refused([&] { parse_calibration(damaged.dump(), "base.json"); },
                  {"base.json is damaged: ", "; fit the flight again"});
  }
}

TEST_CASE("a calibration goes to a file and comes back") {
  const TemporaryFolder folder;
  const Calibration calibration = calibrate_magnetometer();
  const std::string file = (folder.path() / "mag.json").string();
  write_calibration(calibration, file);
  CHECK(read_bytes(file) == to_json(calibration));
  CHECK(to_json(read_calibration(file, "sepcal-mag")) == to_json(calibration));
  check_refused([&] { read_calibration(file, "sepcal-pitot"); }, {file, "use sepcal-mag"});
  check_refused([&] { read_calibration(file + ".old"); },
                {file + ".old: no such file", "fit wrote with -o"});
  check_refused([&] { read_calibration(folder.write("", "empty.json")); },
                {"empty.json is not a calibration", "it is empty"});
  check_refused([&] { read_calibration(folder.path().string()); }, {folder.path().string()});
  check_refused([&] { write_calibration(calibration, (folder.path() / "x" / "y").string()); },
                {"isn't there", "make it first"});
}

TEST_CASE("misuse of a calibration is refused") {
  const auto calibrate_rows = [](std::size_t rows, const CalibrationOptions& options) {
    return [=] {
      calibrate(make_five_hole(), make_flight(simulate_five_hole({}, condensed(rows))), options);
    };
  };
  CalibrationOptions options = quick_options();
  check_refused(calibrate_rows(9, options), {"flight: 9 usable rows", "10 parameters", "log more"});
  CHECK_NOTHROW(calibrate_rows(10, options)());
  options.fit.fix = {{"w_d", 0.3}};
  CHECK_NOTHROW(calibrate_rows(9, options)());
  options.free = {"w_d"};
  check_refused(calibrate_rows(50, options), {"w_d", "contradict", "keep one"});
  options.free = {"w_up"};
  check_refused(calibrate_rows(50, options), {"w_up", "the model has: lambda_va, b_va"});
  options = quick_options();
  options.fit.stage_two_segments = "taxi";
  check_refused(calibrate_rows(50, options),
                {"flight: the segments of stage two (stage_two_segments)", "'taxi'",
                 "within 0 to 117.6", "the labels are: wind_circle_1"});
}

}  // namespace calibration_test
