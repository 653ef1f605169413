// SPDX-License-Identifier: BSD-3-Clause
// JSON that no program of ours wrote: one line is said of it, whatever it holds.
#include <nlohmann/json.hpp>

#include "calibrated_flights.hpp"
#include "sepcal/detail/simulation/truth.hpp"

namespace damaged_json_test {

using namespace sepcal;
using namespace sepcal::test;

namespace {

/// A list in a list in a list ...; to write or to copy it level by level takes a deep stack.
std::string nested(std::size_t levels) {
  return std::string(levels, '[') + std::string(levels, ']');
}

}  // namespace

TEST_CASE("sixty levels of lists are refused like any other value") {
  const std::string lists = nested(60);
  check_refused([&] { parse_calibration(lists, "b.json"); }, {"b.json", "not a calibration"});
  check_refused(
      [&] { parse_calibration(R"({"model": "", "schema_version": )" + lists + "}", "b.json"); },
      {"b.json", "schema version a list", "reads 1 to 3"});
  check_refused([&] { parse_five_hole_truth(R"({"model": )" + lists + "}", "t.json"); },
                {"t.json", "for the model a list"});
  check_refused([&] { parse_magnetometer_truth(R"({"options": )" + lists + "}", "t.json"); },
                {"t.json", "kind"});
}

TEST_CASE("more than 64 levels are too deep, a million of them too") {
  for (const std::size_t levels : {64U, 1'000'000U}) {
    const std::string lists = R"({"model": )" + nested(levels) + "}";
    check_refused([&] { parse_calibration(lists, "b.json"); }, {"b.json", "more than 64 deep"});
    check_refused([&] { parse_pitot_static_truth(lists, "t.json"); }, {"t.json", "more than 64"});
  }
}

TEST_CASE("a name that one object has twice is refused, in two objects it is none of that") {
  check_refused([] { parse_calibration(R"({"fit": {"a": 1, "b": {"a": 2}, "a": 3}})", "b.json"); },
                {"b.json: one object has 'a' twice"});
  check_refused([] { parse_calibration(R"([{"a": 1}, {"a": {"a": 2}}])", "b.json"); },
                {"b.json", "not a calibration"});
}

TEST_CASE("a long value is cut between its characters") {
  std::string name = "x";
  for (int i = 0; i < 1000; ++i) name += "\xC3\xBC";
  try {
    parse_pitot_static_truth(nlohmann::json{{"model", name}}.dump(), "t.json");
    FAIL_CHECK("nothing was thrown");
  } catch (const Error& error) {
    const std::string what = error.what();
    CHECK(what.size() < 200);
    CHECK(what.find("\xC3\xBC...") != std::string::npos);
    CHECK(what.find("\\xc3") == std::string::npos);
  }
}

TEST_CASE("a text with line ends and escape codes is quoted in one line") {
  check_refused([] { parse_magnetometer_truth(R"({"noise": {"m\nx\u001b[2J": 1}})", "t.json"); },
                {"t.json", "'m\\nx\\x1b[2J'"});
  check_refused([] { parse_five_hole_truth(R"({"par\u2028ameters": 1})", "t.json"); },
                {"t.json", "'par\\xe2\\x80\\xa8ameters'"});
}

}  // namespace damaged_json_test
