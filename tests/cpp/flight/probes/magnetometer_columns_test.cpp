// SPDX-License-Identifier: BSD-3-Clause
// From a flight to a magnetometer's record: the true field in body axes, and how it may be given.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

#include "flight_log.hpp"
#include "sepcal/detail/flight/probe_columns.hpp"
#include "sepcal/error.hpp"

namespace magnetometer_columns_test {

using doctest::Approx;
using doctest::Contains;
using sepcal::Error;
using sepcal::not_a_number;
using sepcal::prepare_magnetometer;
using sepcal::test::column;
using sepcal::test::Log;
using sepcal::test::mentions;

namespace {

/// Five rows of a magnetometer with attitude.
Log make_magnetometer_log() {
  Log log;
  log.columns = {{"time_s", {0, 0.1, 0.2, 0.3, 0.4}}, {"mx_ut", {1, 2, 3, 4, 5}},
                 {"my_ut", {6, 7, 8, 9, 10}},         {"mz_ut", {11, 12, 13, 14, 15}},
                 {"roll_rad", {0, 0.5, -1, 2, 3.1}},  {"pitch_rad", {0, 0.3, -0.7, 1.2, -1.5}},
                 {"yaw_rad", {0, 1, -2, 3, 6}}};
  return log;
}

}  // namespace

TEST_CASE("the true field in body axes from attitude and a field, given or logged") {
  Log log = make_magnetometer_log();
  const auto given = prepare_magnetometer(log.build(), {.field = {{20, -1.5, 49}}});
  for (std::size_t i = 0; i < 5; ++i) {
    using Eigen::AngleAxisd;
    using Eigen::Vector3d;
    const Eigen::Matrix3d body_to_ned = (AngleAxisd(log["yaw_rad"][i], Vector3d::UnitZ()) *
                                         AngleAxisd(log["pitch_rad"][i], Vector3d::UnitY()) *
                                         AngleAxisd(log["roll_rad"][i], Vector3d::UnitX()))
                                            .toRotationMatrix();
    const Vector3d h = body_to_ned.transpose() * Vector3d(20, -1.5, 49);
    CHECK(column(given, "hx")[i] == Approx(h.x()).epsilon(1e-14));
    CHECK(column(given, "hy")[i] == Approx(h.y()).epsilon(1e-14));
    CHECK(column(given, "hz")[i] == Approx(h.z()).epsilon(1e-14));
  }
  CHECK(column(given, "be") == std::vector<double>(5, -1.5));
  CHECK(given.record.has("roll"));
  log["bn_nt"].assign(5, 20'000);
  log["be_nt"].assign(5, -1'500);
  log["bd_nt"].assign(5, 49'000);
  const auto logged = prepare_magnetometer(log.build());
  for (const char* name : {"hx", "hy", "hz", "bn", "be", "bd"}) {
    CHECK(column(logged, name) == column(given, name));
  }
}

TEST_CASE("body axes are forward, right, down") {
  constexpr double right_angle = std::numbers::pi / 2;
  const auto turn = [](double roll, double pitch, double yaw) {
    Log log = make_magnetometer_log();
    log["roll_rad"].assign(5, roll);
    log["pitch_rad"].assign(5, pitch);
    log["yaw_rad"].assign(5, yaw);
    const auto prepared = prepare_magnetometer(log.build(), {.field = {{1, 2, 3}}});
    std::array<double, 3> h{};
    for (std::size_t i = 0; i < 3; ++i) {
      h[i] = std::round(column(prepared, std::array{"hx", "hy", "hz"}[i])[0] * 1e12) / 1e12;
    }
    return h;
  };
  CHECK(turn(0, 0, 0) == std::array{1.0, 2.0, 3.0});
  CHECK(turn(0, 0, right_angle) == std::array{2.0, -1.0, 3.0});  // nose to the east: north is left
  CHECK(turn(0, right_angle, 0) == std::array{-3.0, 2.0, 1.0});  // nose up: down is behind
  CHECK(turn(right_angle, 0, 0) == std::array{1.0, 3.0, -2.0});  // right wing down: down is right
}

TEST_CASE("a logged true field goes before attitude, a given field before both") {
  Log log = make_magnetometer_log();
  log["hx_gauss"].assign(5, 0.5);
  log["hy_ut"].assign(5, 2);
  log["hz_ut"].assign(5, 3);
  const auto logged = prepare_magnetometer(log.build());
  CHECK(column(logged, "hx") == std::vector<double>(5, 50));
  CHECK(logged.record.has("roll"));
  CHECK_FALSE(logged.record.has("bn"));
  const auto given = prepare_magnetometer(log.build(), {.field = {{20, 0, 40}}});
  CHECK(column(given, "hx")[0] == 20);
  CHECK(mentions(given.notes, "the field given replaces hx, hy and hz"));
  log["roll_rad"][2] = not_a_number;
  const auto without_attitude = prepare_magnetometer(log.build());
  CHECK_FALSE(without_attitude.record.has("roll"));
  CHECK(mentions(without_attitude.notes, "column 'roll_rad' is not used"));
}

TEST_CASE("a magnetometer's flight that lacks something") {
  Log log = make_magnetometer_log();
  CHECK_THROWS_WITH_AS(prepare_magnetometer(log.build()), Contains("the true field is missing"),
                       Error);
  CHECK_THROWS_WITH_AS(prepare_magnetometer(log.build()), Contains("or field N,E,D"), Error);
  CHECK_THROWS_WITH_AS(prepare_magnetometer(log.build(), {.field = {{1, not_a_number, 3}}}),
                       Contains("three finite numbers"), Error);
  CHECK_THROWS_WITH_AS(
      prepare_magnetometer(log.rename("yaw_rad", "heading").build(), {.field = {{1, 2, 3}}}),
      Contains("column 'yaw_rad' is missing"), Error);
  CHECK_THROWS_WITH_AS(prepare_magnetometer(log.rename("mx_ut", "mx_pt").build()),
                       Contains("mx_nt, mx_t, mx_mt, mx_gauss, mx_mgauss"), Error);
  CHECK_THROWS_WITH_AS(prepare_magnetometer(log.erase("mx_pt").build()),
                       Contains("column 'mx_ut' is missing"), Error);
}

TEST_CASE("the field's strength alone needs neither attitude nor field") {
  Log log = make_magnetometer_log();
  for (const char* header : {"roll_rad", "pitch_rad", "yaw_rad"}) log.erase(header);
  log.rename("mx_ut", "mx_nt");
  log["temp_degc"].assign(5, 20);
  const auto prepared = sepcal::prepare_attitude_independent(log.build(), 50.0);
  CHECK(prepared.record.names() ==
        std::vector<std::string>{"time", "mx", "my", "mz", "field", "temp_degc"});
  CHECK(column(prepared, "mx")[1] == 0.002);
  CHECK(column(prepared, "field") == std::vector<double>(5));
  log["my_ut"][2] = not_a_number;
  CHECK_THROWS_WITH_AS(sepcal::prepare_attitude_independent(log.build(), 50.0),
                       Contains("log row 2"), Error);
  CHECK(
      sepcal::prepare_attitude_independent(log.build(), 50.0, {.drop_invalid = true}).rows_used() ==
      4);
  // Unordered readings, without a time, are fitted.
  CHECK(sepcal::prepare_attitude_independent(log.erase("time_s").build(), 50.0,
                                             {.drop_invalid = true})
            .rows_used() == 4);
}

TEST_CASE("applying a magnetometer calibration needs its readings only") {
  Log log = make_magnetometer_log();
  for (const char* header : {"time_s", "roll_rad", "pitch_rad", "yaw_rad"}) log.erase(header);
  log.rename("my_ut", "my_mgauss");
  log["mz_ut"][3] = not_a_number;
  CHECK_THROWS_WITH_AS(sepcal::read_magnetometer(log.build()), Contains("log row 3"), Error);
  const auto readings = sepcal::read_magnetometer(log.build(), {.drop_invalid = true});
  CHECK(readings.record.names() == std::vector<std::string>{"mx", "my", "mz"});
  CHECK(readings.record.column("my")[0] == 0.6);
  CHECK(readings.record.length() == 5);
  CHECK(readings.valid == std::vector<bool>{true, true, true, false, true});
}

TEST_CASE("a number that is too large in the unit used inside is none") {
  Log log = make_magnetometer_log();
  log.rename("mx_ut", "mx_gauss")["mx_gauss"][2] = 1e308;  // 1 gauss is 100 uT
  CHECK_THROWS_WITH_AS(
      sepcal::prepare_attitude_independent(log.build(), 50.0),
      Contains("log row 2: column 'mx_gauss' holds 1e+308, too large to compute with"), Error);
  const auto prepared =
      sepcal::prepare_attitude_independent(log.build(), 50.0, {.drop_invalid = true});
  CHECK(prepared.rows_used() == 4);
  log.rename("mx_gauss", "mx_ut")["mx_ut"][2] = 1e149;
  CHECK(sepcal::prepare_attitude_independent(log.build(), 50.0).rows_used() == 5);
  for (const char* rate : {"p_degps", "q_degps", "r_degps"}) log[rate].assign(5, 1.0);
  log["q_degps"][1] = -1e308;
  const auto without_rates = sepcal::prepare_attitude_independent(log.build(), 50.0);
  CHECK_FALSE(without_rates.record.has("q"));
  CHECK(mentions(without_rates.notes, "column 'q_degps' is not used: holds -1e+308, too large"));
}

TEST_CASE("times that differ as logged and are one in seconds do not increase") {
  Log log = make_magnetometer_log();
  // A double of this size tells quarters of a microsecond apart, and in seconds only halves.
  log.rename("time_s", "time_us")["time_us"] = {0, 2200000000000000.25, 2200000000000000.50, 2.3e15,
                                                2.4e15};
  CHECK_THROWS_WITH_AS(sepcal::prepare_attitude_independent(log.build(), 50.0),
                       Contains("log row 2: time_us repeats at"), Error);
}

}  // namespace magnetometer_columns_test
