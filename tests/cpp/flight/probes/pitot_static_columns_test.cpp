// SPDX-License-Identifier: BSD-3-Clause
// From a flight to a Pitot-static tube's record: the two ways to the airspeed, the density where it
// is there, still air.
#include <doctest/doctest.h>

#include <cmath>

#include "flight_log.hpp"
#include "sepcal/detail/flight/probe_columns.hpp"
#include "sepcal/error.hpp"

namespace pitot_static_columns_test {

using doctest::Approx;
using doctest::Contains;
using sepcal::Error;
using sepcal::not_a_number;
using sepcal::prepare_pitot_static;
using sepcal::read_pitot_static;
using sepcal::test::column;
using sepcal::test::Log;
using sepcal::test::mentions;

namespace {

/// Ten rows with nothing but what is needed.
Log make_log() {
  Log log;
  log.columns = {{"time_s", {0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9}},
                 {"vn_mps", std::vector<double>(10, 30)},
                 {"ve_mps", std::vector<double>(10, -5)},
                 {"vd_mps", std::vector<double>(10, 1)},
                 {"airspeed_mps", {30, 31, 32, 33, 34, 35, 36, 37, 38, 39}}};
  return log;
}

/// The same with the differential pressure instead.
Log make_pressure_log() {
  Log log = make_log();
  log.rename("airspeed_mps", "dp_pa");
  log["dp_pa"].assign(10, 612.5);  // 0.5 * 1.225 * 31.6228^2
  return log;
}

}  // namespace

TEST_CASE("a logged airspeed in any unit") {
  const auto prepared = prepare_pitot_static(make_log().build());
  CHECK(prepared.record.names() == std::vector<std::string>{"time", "vn", "ve", "vd", "airspeed"});
  CHECK(column(prepared, "airspeed")[9] == 39);
  Log log = make_log();
  log.rename("airspeed_mps", "airspeed_kt");
  CHECK(column(prepare_pitot_static(log.build()), "airspeed")[0] ==
        Approx(30 * 1852.0 / 3600).epsilon(1e-14));
}

TEST_CASE("the airspeed of a differential pressure and the density") {
  Log log = make_pressure_log();
  log["rho_kgpm3"].assign(10, 1.225);
  const auto logged = prepare_pitot_static(log.build());
  CHECK(column(logged, "airspeed")[3] == Approx(std::sqrt(1000.0)).epsilon(1e-14));
  CHECK(column(logged, "rho")[3] == 1.225);
  CHECK(column(logged, "dp")[3] == 612.5);
  log.erase("rho_kgpm3");
  log["temp_degc"].assign(10, 15);
  log["ps_hpa"].assign(10, 1013.25);
  const auto computed = prepare_pitot_static(log.build());
  // ISO 2533: 1.225 kg/m^3 at sea level, at 101325 Pa and 288.15 K.
  CHECK(column(computed, "airspeed")[3] == Approx(std::sqrt(1000.0)).epsilon(1e-7));
  CHECK(column(computed, "rho")[3] == Approx(1.225).epsilon(1e-7));
  CHECK(column(computed, "ps")[3] == Approx(101325));
  CHECK(column(computed, "temperature")[3] == Approx(288.15));
  CHECK(column(computed, "temp_degc")[3] == 15);
}

TEST_CASE("a logged airspeed goes before a computed one, and what else is there is kept") {
  Log log = make_log();
  log["dp_pa"].assign(10, 1);
  log["rho_kgpm3"].assign(10, 0.9);
  for (const char* header : {"roll_rad", "pitch_rad", "yaw_rad", "p_radps", "q_radps", "r_radps"}) {
    log[header].assign(10, 0.1);
  }
  log["altitude_m"].assign(10, 500);
  const auto prepared = prepare_pitot_static(log.build());
  CHECK(column(prepared, "airspeed")[1] == 31);
  for (const char* name : {"dp", "rho", "roll", "pitch", "yaw", "p", "q", "r", "altitude_m"}) {
    CHECK(prepared.record.has(name));
  }
}

TEST_CASE("a density that is not one is left out beside a logged airspeed") {
  Log log = make_log();
  log["rho_kgpm3"].assign(10, 1.2);
  log["rho_kgpm3"][4] = 0;
  const auto prepared = prepare_pitot_static(log.build());
  CHECK_FALSE(prepared.record.has("rho"));
  CHECK(prepared.rows_used() == 10);
  CHECK(mentions(prepared.notes, "the density is not used"));
}

TEST_CASE("rows in still air are dropped, up to a fifth") {
  Log log = make_log();
  log["airspeed_mps"][0] = 0;
  log["airspeed_mps"][1] = -1;
  const auto prepared = prepare_pitot_static(log.build());
  CHECK(prepared.rows_used() == 8);
  CHECK(mentions(prepared.notes, "2 of 10 rows were dropped: airspeed is not above zero"));
  log["airspeed_mps"][2] = 0;
  CHECK_THROWS_WITH_AS(
      prepare_pitot_static(log.build()),
      Contains("airspeed is not above zero in 3 of 10 rows, more than a fifth (the "
               "first is log row 0); check the column"),
      Error);
  Log pressure = make_pressure_log();
  pressure["rho_kgpm3"].assign(10, 1.2);
  pressure["dp_pa"][5] = -3;
  CHECK(prepare_pitot_static(pressure.build()).rows_used() == 9);
}

TEST_CASE("a flight that lacks something") {
  const auto refuse = [](const Log& log, const std::string& words) {
    CHECK_THROWS_WITH_AS(prepare_pitot_static(log.build()), Contains(words.c_str()), Error);
  };
  refuse(make_log().erase("airspeed_mps"),
         "the airspeed is missing: log airspeed_mps, or dp_pa with rho_kgpm3");
  refuse(make_pressure_log(), "the density is missing: log rho_kgpm3, or temp_k and ps_pa");
  refuse(make_log().erase("vd_mps"), "column 'vd_mps' is missing");
  refuse(make_log().rename("airspeed_mps", "airspeed_mach"), "airspeed_mps, airspeed_kt");
  Log log = make_log();
  log["airspeed_mps"][6] = not_a_number;
  refuse(log, "log row 6");
  CHECK(prepare_pitot_static(log.build(), {.drop_invalid = true}).rows_used() == 9);
  Log pressure = make_pressure_log();
  pressure["rho_kgpm3"].assign(10, -1.2);
  refuse(pressure, "rho is not positive");
}

TEST_CASE("applying a calibration needs the reading alone") {
  Log log = make_log();
  for (const char* header : {"time_s", "vn_mps", "ve_mps", "vd_mps"}) log.erase(header);
  log["airspeed_mps"][2] = 0;
  const auto readings = read_pitot_static(log.build());
  CHECK(readings.record.column("airspeed")[3] == 33);
  CHECK(readings.record.length() == 10);
  CHECK(readings.valid[1]);
  CHECK_FALSE(readings.valid[2]);
  CHECK(readings.record.column("rho")[3] == 1.225);
  log["rho_kgpm3"].assign(10, 1.1);
  log["rho_kgpm3"][2] = not_a_number;
  CHECK(read_pitot_static(log.build()).record.column("rho")[3] == 1.1);
}

TEST_CASE("readings of which no airspeed can be computed name their row") {
  Log log = make_pressure_log();
  log["rho_kgpm3"].assign(10, 1.225);
  log["dp_pa"][6] = 1e100;
  log["rho_kgpm3"][6] = 1e-300;
  CHECK_THROWS_WITH_AS(prepare_pitot_static(log.build()),
                       Contains("log row 6: airspeed is computed from this row's readings as inf"),
                       Error);
}

}  // namespace pitot_static_columns_test
