// SPDX-License-Identifier: BSD-3-Clause
// Logs whose headers promise another unit than the cells are in, and logs that are merely unusual.
#include "flight/probes/plausible_readings.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "flight_log.hpp"

namespace plausible_readings_test {

using doctest::Contains;
using sepcal::files::UnitKind;
using sepcal::probes::find_implausible;
using sepcal::probes::Implausible;
using sepcal::probes::Reading;
using sepcal::test::Log;
using sepcal::test::mentions;
using Values = std::vector<double>;

namespace {

struct Readings {
  std::map<std::string, Reading, std::less<>> readings;

  Readings& add(const std::string& quantity, UnitKind kind, const Values& values) {
    const std::string header =
        quantity + "_" + std::string(sepcal::files::known_units(kind)[0].suffix);
    readings[quantity] = {header, kind, values};
    return *this;
  }
  std::vector<std::string> describe() const {
    std::vector<std::string> sentences;
    const auto find = [this](std::string_view quantity) -> std::optional<Reading> {
      const auto found = readings.find(quantity);
      return found == readings.end() ? std::nullopt : std::optional(found->second);
    };
    for (const Implausible& found : find_implausible(find)) sentences.push_back(found.sentence);
    return sentences;
  }
};

/// The one sentence about it, or what there was in its place.
std::string describe(const std::string& quantity, UnitKind kind, const Values& values) {
  const auto sentences = Readings().add(quantity, kind, values).describe();
  return sentences.size() == 1 ? sentences[0] : std::to_string(sentences.size()) + " sentences";
}

Readings pressures(double total, double fixed) {
  return Readings()
      .add("pt", UnitKind::pressure, Values(5, total))
      .add("ps", UnitKind::pressure, Values(5, fixed));
}

Readings field(const std::string& letter, double strength) {
  return Readings()
      .add(letter + (letter == "b" ? "n" : "x"), UnitKind::field, {0.6 * strength})
      .add(letter + (letter == "b" ? "e" : "y"), UnitKind::field, {0})
      .add(letter + (letter == "b" ? "d" : "z"), UnitKind::field, {-0.8 * strength});
}

constexpr const char* silence = "0 sentences";

}  // namespace

TEST_CASE("angles beyond a turn look like degrees") {
  CHECK(describe("yaw", UnitKind::angle, {1, 90, 213, -2}) ==
        "column 'yaw_rad' lies outside -6.3 to 6.3 rad in 2 of 4 rows (it goes from -2 to 213); if "
        "it is in deg, --map yaw_deg=yaw_rad reads it so");
  CHECK(describe("roll", UnitKind::angle, {6.4}).starts_with("column 'roll_rad' lies outside"));
  CHECK(describe("pitch", UnitKind::angle, {0, -12}).find("in deg") != std::string::npos);
  CHECK(describe("yaw", UnitKind::angle, {0, 6.28, -6.28}) == silence);
  CHECK(describe("pitch", UnitKind::angle, {1.57, -1.57}) == silence);
  // Heading that counts its turns fits no unit.
  CHECK(describe("yaw", UnitKind::angle, {0, 500}).ends_with("; check its unit"));
}

TEST_CASE("a yaw that counts its turns in radians") {
  Values time, yaw, north, east, rate, in_degrees;
  for (int i = 0; i < 400; ++i) {
    time.push_back(0.1 * i);
    yaw.push_back(0.05 * i);  // 20 rad: three turns and more, at 0.5 rad/s
    north.push_back(15.0 * std::cos(yaw.back()) + 3.0);
    east.push_back(15.0 * std::sin(yaw.back()) - 2.0);
    rate.push_back(0.5);
    in_degrees.push_back(std::fmod(yaw.back() * 57.29577951308232, 360.0));
  }
  const auto with_course = [&](const Values& values) {
    return Readings()
        .add("yaw", UnitKind::angle, values)
        .add("vn", UnitKind::speed, north)
        .add("ve", UnitKind::speed, east)
        .describe();
  };
  const auto with_rate = [&](const Values& values) {
    return Readings()
        .add("yaw", UnitKind::angle, values)
        .add("time", UnitKind::time, time)
        .add("r", UnitKind::rate, rate)
        .describe();
  };
  const auto with_field = [&](const Values& values) {
    Values x, y, z;
    for (const double angle : yaw) {  // level, with hard iron
      x.push_back(20.0 * std::cos(angle) + 8.0);
      y.push_back(-20.0 * std::sin(angle) - 5.0);
      z.push_back(45.0);
    }
    return Readings()
        .add("yaw", UnitKind::angle, values)
        .add("mx", UnitKind::field, x)
        .add("my", UnitKind::field, y)
        .add("mz", UnitKind::field, z)
        .describe();
  };
  CHECK(with_field(yaw).empty());
  REQUIRE(with_field(in_degrees).size() == 1);
  CHECK(with_field(in_degrees)[0].ends_with("--map yaw_deg=yaw_rad reads it so"));
  CHECK(with_course(yaw).empty());
  CHECK(with_rate(yaw).empty());
  REQUIRE(with_course(in_degrees).size() == 1);
  CHECK(with_course(in_degrees)[0].ends_with("--map yaw_deg=yaw_rad reads it so"));
  REQUIRE(with_rate(in_degrees).size() == 1);
  CHECK(with_rate(in_degrees)[0].ends_with("--map yaw_deg=yaw_rad reads it so"));
}

TEST_CASE("a yaw that counts its turns, with nothing beside it but time") {
  constexpr double of_degree = 0.017453292519943295;
  Values time, turns, degrees, jumping;
  for (int row = 0; row < 400; ++row) {
    time.push_back(0.1 * row);
    turns.push_back(0.04 * row);                                      // 0.4 rad/s
    degrees.push_back(0.04 * row / of_degree);                        // the same, going on
    jumping.push_back(std::fmod(0.04 * row, 6.2831853) / of_degree);  // and turning over
  }
  const auto said = [&](const Values& yaw) {
    return Readings()
        .add("yaw", UnitKind::angle, yaw)
        .add("time", UnitKind::time, time)
        .describe()
        .size();
  };
  CHECK(said(turns) == 0);
  CHECK(said(degrees) == 1);
  CHECK(said(jumping) == 1);
  CHECK(Readings().add("yaw", UnitKind::angle, turns).describe().size() == 1);  // nobody can tell
}

TEST_CASE("temperature, density and static pressure") {
  CHECK(describe("temp", UnitKind::temperature, {12, 15}).find("if it is in degc") !=
        std::string::npos);
  CHECK(describe("temp", UnitKind::temperature, {216, 310}) == silence);
  CHECK(describe("rho", UnitKind::density, {1.2, 1200}).ends_with("; check its unit"));
  CHECK(describe("rho", UnitKind::density, {0.09, 1.4}) == silence);
  CHECK(describe("ps", UnitKind::pressure, {950, 1013}).find("hpa or psf") != std::string::npos);
  CHECK(describe("ps", UnitKind::pressure, {700}).find("hpa or psf or torr") != std::string::npos);
  CHECK(describe("ps", UnitKind::pressure, {14.7}).find("kpa or psi") != std::string::npos);
  CHECK(describe("ps", UnitKind::pressure, {2.2e4, 1.08e5}) == silence);
}

TEST_CASE("a unit is only suggested for a header that names the one used inside") {
  Readings readings;
  readings.readings["ps"] = {"ps_hpa", std::nullopt, {1013}};
  CHECK(readings.describe()[0].ends_with("; check its unit"));
  readings.readings = {{"yaw", {"yaw_deg", std::nullopt, {7.5}}}};  // turns may be counted
  CHECK(readings.describe().empty());
}

TEST_CASE("a dynamic pressure that nothing flies at") {
  CHECK(pressures(90'200, 90'000).describe().empty());
  CHECK(pressures(90'000.2, 90'000).describe()[0] ==
        "pt_pa - ps_pa is usually 0.2 Pa, which lies outside 1 to 50000 Pa; check the unit");
  CHECK(describe("dp", UnitKind::pressure, {0.3, 0.2, 0.3}) ==
        "column 'dp_pa' is usually 0.3 Pa, which lies outside 1 to 50000 Pa; check the unit");
  CHECK(describe("dp", UnitKind::pressure, {0.1, 180, 190}) == silence);  // at rest to begin with
}

TEST_CASE("flow-angle pressures out of proportion to the dynamic pressure") {
  const auto with_ports = [](const Values& values) {
    return pressures(90'200, 90'000).add("dpa", UnitKind::pressure, values).describe();
  };
  CHECK(with_ports({40, -60, 500, 20, 10}).empty());
  CHECK(with_ports({0, 0, 0, 0, 0}).empty());  // still air in the simplest of simulations
  CHECK(with_ports({0.04, -0.06, 0.1, 0.02, 0.01}) ==
        std::vector<std::string>{"column 'dpa_pa' is out of proportion: it is at most 0.0005 times "
                                 "pt_pa - ps_pa; check both units"});
  CHECK(with_ports({4000, -6000, 10, 2000, 1000}) ==
        std::vector<std::string>{"column 'dpa_pa' is out of proportion: it is usually 10 times "
                                 "pt_pa - ps_pa; check both units"});
}

TEST_CASE("fields that are not the Earth's") {
  CHECK(field("h", 53).describe().empty());
  CHECK(field("m", 350).describe().empty());  // iron beside the sensor
  CHECK(field("b", 350).describe().size() == 1);
  CHECK(field("h", 0.53).describe()[0] ==
        "the field of hx_ut, hy_ut, hz_ut is usually 0.53 uT strong, which lies outside 5 to 200 "
        "uT; if it is in gauss, --map hx_gauss=hx_ut,hy_gauss=hy_ut,hz_gauss=hz_ut reads it so");
  CHECK(field("m", 530).describe()[0].find("if it is in mgauss,") != std::string::npos);
  CHECK(field("b", 53'000).describe()[0].find("if it is in nt,") != std::string::npos);
}

TEST_CASE("a field that is given is no column of the log") {
  Log log;
  log.columns.emplace_back("time_s", Values{0, 0.1, 0.2, 0.3});
  for (const char* header : {"mx_ut", "my_ut", "mz_ut", "roll_rad", "pitch_rad", "yaw_rad"}) {
    log[header] = {30, 31, 32, 33};
  }
  CHECK(mentions(sepcal::prepare_magnetometer(log.build(), {.field = {{3e4, 0, 4e4}}}).notes,
                 "log: the field given is 5e+04 uT strong, which lies outside 5 to 200 uT; if it "
                 "is in nT, give a thousandth of it"));
}

TEST_CASE(
    "a flight's notes carry it, from the rows that are used and in the flight's own headers") {
  Log log;
  log.columns.emplace_back("time_s", Values{0, 0.1, 0.2, 0.3});
  for (const char* header : {"hx_ut", "hy_ut", "hz_ut", "mx_ut", "my_ut", "mz_ut"}) {
    log[header].assign(4, 30);
  }
  CHECK(sepcal::prepare_magnetometer(log.build()).notes.empty());
  log["mx_ut"] = {30, 3e5, 3e5, std::nan("")};
  CHECK(sepcal::read_magnetometer(log.build(), {.drop_invalid = true}).notes.size() == 2);
  log["mx_ut"] = {3e5, 3e5, 3e5, 3e5};
  const std::string expected =
      "log: the field of mx_ut, my_ut, mz_ut is usually 3e+05 uT strong, which lies outside";
  CHECK(mentions(sepcal::prepare_magnetometer(log.build()).notes, expected));
  CHECK(mentions(sepcal::read_magnetometer(log.build()).notes, expected));
}

}  // namespace plausible_readings_test
