// SPDX-License-Identifier: BSD-3-Clause
// From a flight to a five-hole probe's record: quantities, units, bad rows, drivers, segments.
#include "sepcal/detail/flight/probe_columns.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>

#include "flight_log.hpp"
#include "sepcal/error.hpp"
#include "temporary_folder.hpp"

namespace probe_columns_test {

using doctest::Approx;
using doctest::Contains;
using sepcal::Error;
using sepcal::Flight;
using sepcal::not_a_number;
using sepcal::prepare_five_hole;
using sepcal::read_csv;
using sepcal::test::column;
using sepcal::test::Log;
using sepcal::test::mentions;
using sepcal::test::TemporaryFolder;

namespace {

/// Ten rows, 0.1 s apart; column i holds 100 i + row, but for time, ps and rho.
Log make_five_hole_log() {
  Log log;
  double base = 0;
  for (const char* header :
       {"time_s", "roll_rad", "pitch_rad", "yaw_rad", "p_radps", "q_radps", "r_radps", "vn_mps",
        "ve_mps", "vd_mps", "pt_pa", "ps_pa", "dpa_pa", "dpb_pa", "rho_kgpm3"}) {
    std::vector<double> values(10);
    for (double& value : values) value = base + static_cast<double>(&value - values.data());
    log.columns.emplace_back(header, values);
    base += 100;
  }
  for (std::size_t i = 0; i < 10; ++i) log["time_s"][i] = 0.1 * static_cast<double>(i);
  log["ps_pa"].assign(10, 900);
  log["rho_kgpm3"].assign(10, 1.2);
  return log;
}

/// The message with which a five-hole flight is refused.
std::string refuse(const Flight& flight, const sepcal::FiveHoleColumns& options = {}) {
  try {
    prepare_five_hole(flight, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was refused";
}

constexpr const char* five_hole_header =
    "time_s,roll_rad,pitch_rad,yaw_rad,vn_mps,ve_mps,vd_mps,pt_pa,ps_pa,dpa_pa,dpb_pa,rho_kgpm3\n";

}  // namespace

TEST_CASE("quantities come by base name, without a copy where nothing changes") {
  const Flight flight = make_five_hole_log().build();
  const auto prepared = prepare_five_hole(flight);
  CHECK(prepared.record.names() == std::vector<std::string>{"time", "roll", "pitch", "yaw", "vn",
                                                            "ve", "vd", "pt", "ps", "dpa", "dpb",
                                                            "rho", "p", "q", "r"});
  for (const auto& logged : flight.columns()) {
    const auto name = logged.header.substr(0, logged.header.rfind('_'));
    CHECK(prepared.record.column(name).data() == logged.values.data());
  }
  CHECK(prepared.rows_read == 10);
  CHECK(prepared.rows_used() == 10);
  CHECK(prepared.dropped.empty());
  CHECK(mentions(prepared.notes, "column 'roll_rad' lies outside -6.3 to 6.3 rad"));
}

TEST_CASE("the record outlives the flight") {
  const auto prepared = [] {
    const Flight flight = make_five_hole_log().build();
    return prepare_five_hole(flight);
  }();
  CHECK(column(prepared, "roll")[9] == 109);
}

TEST_CASE("units are converted") {
  Log log = make_five_hole_log();
  log.rename("roll_rad", "roll_deg").rename("vn_mps", "vn_kmh").rename("time_s", "time_ms");
  log.rename("q_radps", "q_degps");
  log["roll_deg"].assign(10, 90);
  log["vn_kmh"].assign(10, 36);
  log["q_degps"].assign(10, 180);
  for (double& time : log["time_ms"]) time *= 1000;
  const auto prepared = prepare_five_hole(log.build());
  CHECK(column(prepared, "roll")[3] == Approx(std::numbers::pi / 2).epsilon(1e-15));
  CHECK(column(prepared, "vn")[3] == 10);
  CHECK(column(prepared, "q")[3] == Approx(std::numbers::pi).epsilon(1e-15));
  CHECK(column(prepared, "time")[9] == Approx(0.9).epsilon(1e-15));
}

TEST_CASE("density from static pressure and temperature") {
  Log log = make_five_hole_log();
  log.erase("rho_kgpm3");
  log["temp_degc"].assign(10, 15);
  log["ps_pa"].assign(10, 101325);
  for (double& pt : log["pt_pa"]) pt += 101325;
  const auto prepared = prepare_five_hole(log.build());
  // ISO 2533: 1.225 kg/m^3 at sea level, at 101325 Pa and 288.15 K.
  CHECK(column(prepared, "rho")[0] == Approx(1.225).epsilon(1e-7));
  CHECK_FALSE(prepared.record.has("temp"));
  CHECK(column(prepared, "temp_degc")[0] == 15);
  // A logged density goes before one that is computed.
  log["rho_kgpm3"].assign(10, 1.1);
  CHECK(column(prepare_five_hole(log.build()), "rho")[0] == 1.1);
  log.erase("rho_kgpm3").erase("temp_degc");
  CHECK(refuse(log.build())
            .starts_with("log: the density is missing: log rho_kgpm3 or temp_k; the flight has: "
                         "time_s, roll_rad"));
}

TEST_CASE("a density that is not positive is refused or dropped") {
  Log log = make_five_hole_log();
  log["rho_kgpm3"][4] = 0;
  CHECK(refuse(log.build()) == "log row 4: rho is not positive; drop_invalid drops such rows");
  CHECK(prepare_five_hole(log.build(), {.log = {.drop_invalid = true}}).rows_used() == 9);
  log.erase("rho_kgpm3");
  log["temp_k"].assign(10, 288);
  log["temp_k"][6] = -1;
  CHECK_MESSAGE(refuse(log.build()).starts_with("log row 6: ps or the absolute temperature"), "T");
}

TEST_CASE("rates are zeros unless they are logged, and needed with a lever arm") {
  Log log = make_five_hole_log();
  CHECK(column(prepare_five_hole(log.build()), "q")[1] == 501);
  log.erase("q_radps");
  const auto without = prepare_five_hole(log.build());
  for (const char* rate : {"p", "q", "r"}) CHECK(column(without, rate) == std::vector<double>(10));
  CHECK(refuse(log.build(), {.lever_arm = true})
            .starts_with("log: column 'q_radps' is missing (q_degps would do as well)"));
  // A bad cell in a rate that isn't needed only costs the rates.
  log["q_radps"].assign(10, not_a_number);
  const auto bad = prepare_five_hole(log.build());
  CHECK(column(bad, "p") == std::vector<double>(10));
  CHECK(mentions(bad.notes, "log: column 'q_radps' is not used: holds nan"));
  CHECK(refuse(log.build(), {.lever_arm = true}) ==
        "log row 0: column 'q_radps' holds nan, not a finite number, and has none in any of 10 "
        "rows; map reads it from another column");
}

TEST_CASE("missing columns, unknown units, quantities given twice") {
  for (const char* header : {"time_s", "roll_rad", "pitch_rad", "yaw_rad", "vn_mps", "ve_mps",
                             "vd_mps", "pt_pa", "ps_pa", "dpa_pa", "dpb_pa"}) {
    CHECK(refuse(make_five_hole_log().rename(header, "other").build())
              .starts_with("log: column '" + std::string(header) + "' is missing ("));
  }
  CHECK(refuse(make_five_hole_log().rename("roll_rad", "roll_grad").build()) ==
        "log: column 'roll_grad' has no known unit; roll may be logged as: roll_rad, roll_deg; "
        "map roll_rad=roll_grad reads it as the first");
  Log bare = make_five_hole_log().rename("roll_rad", "roll");  // beyond a turn in radians
  CHECK(mentions({refuse(bare.build())}, "map roll_deg=roll reads it in deg; known too: rad"));
  bare["roll"].assign(10, 0.3);
  CHECK(refuse(bare.build())
            .starts_with("log: column 'roll_rad' is missing (roll_deg would do as well); 'roll' "
                         "says no unit that is known: map roll_rad=roll reads it in rad; known "
                         "too: deg; a quaternion from body to north-east-down would do as well: "));
  const Log without_unit = make_five_hole_log().rename("p_radps", "p_rpm");
  CHECK(refuse(without_unit.build(), {.lever_arm = true}) ==
        "log: column 'p_rpm' has no known unit; p may be logged as: p_radps, p_degps; map "
        "p_radps=p_rpm reads it as the first");
  CHECK(mentions(prepare_five_hole(without_unit.build()).notes,
                 "column 'p_rpm' is not read as p, which this fit does without: its unit is "
                 "unknown"));
  Log log = make_five_hole_log();
  log["roll_deg"];
  CHECK(refuse(log.build()) ==
        "log: roll is there twice, as 'roll_rad' and 'roll_deg'; ignore roll_deg leaves one "
        "out");
}

TEST_CASE("an unknown unit beside a known one is a column like any other") {
  Log log = make_five_hole_log();
  log["time_utc"].assign(10, 7);
  log["yaw_magnetic_deg"].assign(10, 8);
  const auto prepared = prepare_five_hole(log.build());
  CHECK(column(prepared, "time_utc")[0] == 7);
  CHECK(column(prepared, "yaw_magnetic_deg")[0] == 8);
}

TEST_CASE("candidate drivers are whole numeric columns, as they stand") {
  Log log = make_five_hole_log();
  log["altitude_ft"].assign(10, 3000);
  log["current_a"].assign(10, 1);
  log["current_a"][3] = not_a_number;
  log["time"].assign(10, 5);
  const auto prepared = prepare_five_hole(log.build());
  CHECK(column(prepared, "altitude_ft") == std::vector<double>(10, 3000));
  CHECK_FALSE(prepared.record.has("current_a"));
  CHECK(
      mentions(prepared.notes, "column 'current_a' can't drive an effect: at log row 3 it holds"));
  CHECK(mentions(prepared.notes, "column 'time' can't drive an effect: it is named like"));
  CHECK(column(prepared, "time")[0] == 0);
  // Where the only bad cell is in a row that is dropped anyway, the driver stays.
  log["vn_mps"][3] = not_a_number;
  CHECK(prepare_five_hole(log.build(), {.log = {.drop_invalid = true}}).record.has("current_a"));
}

TEST_CASE("a bad cell in a needed column names line and column") {
  const TemporaryFolder folder;
  const auto with_cell = [&](const std::string& cell) {
    return folder.write(five_hole_header + std::string("0,0,0,0,1,1,1,1000,900,1,1,1.2\n") +
                        "0.1,0,0," + cell + ",1,1,1,1000,900,1,1,1.2\n" +
                        "0.2,0,0,0,1,1,1,1000,900,1,1,1.2\n");
  };
  const auto file = with_cell("n/a");
  CHECK(refuse(read_csv(file)) == file +
                                      " line 3: column 'yaw_rad' holds 'n/a', not a finite "
                                      "number; drop_invalid drops such rows");
  CHECK_MESSAGE(refuse(read_csv(with_cell(""))).find("'yaw_rad' is empty") != std::string::npos,
                "");
  for (const char* cell : {"nan", "inf", "0x1", "1e999"}) {
    CHECK_MESSAGE(
        refuse(read_csv(with_cell(cell)))
                .find("line 3: column 'yaw_rad' holds '" + std::string(cell)) != std::string::npos,
        cell);
  }
  std::string wide = "x";
  for (int i = 0; i < 30; ++i) wide += "\xC2\xB5";
  CHECK_MESSAGE(refuse(read_csv(with_cell(wide))).find("\xC2\xB5', not") != std::string::npos,
                "cut between characters");
  const auto prepared =
      prepare_five_hole(read_csv(with_cell("n/a")), {.log = {.drop_invalid = true}});
  CHECK(prepared.rows_read == 3);
  CHECK(prepared.rows_used() == 2);
  CHECK(prepared.flight_rows == std::vector<std::size_t>{0, 2});
  REQUIRE(prepared.dropped.size() == 1);
  CHECK(prepared.dropped[0].rows == 1);
  CHECK(prepared.dropped[0].reason == "a cell of a needed column is no finite number");
  CHECK(mentions(prepared.notes, "1 of 3 rows were dropped"));
}

TEST_CASE("time that repeats or runs back names the line") {
  Log log = make_five_hole_log();
  log["time_s"][4] = log["time_s"][3];
  CHECK(refuse(log.build()).starts_with("log row 4: time_s repeats at 0.3"));
  log["time_s"][4] = 0.05;
  CHECK(refuse(log.build()).starts_with("log row 4: time_s runs back at 0.05"));
  log["vn_mps"][4] = not_a_number;
  CHECK(prepare_five_hole(log.build(), {.log = {.drop_invalid = true}}).rows_used() == 9);
  const TemporaryFolder folder;
  const std::string row = ",0,0,0,1,1,1,1000,900,1,1,1.2\n";
  const auto file = folder.write(five_hole_header + ("0" + row) + ("1" + row) + ("1" + row));
  CHECK(refuse(read_csv(file))
            .starts_with(file + " line 4: time_s repeats at 1, after 1; time must"));
}

TEST_CASE("rows without excess pressure are dropped, up to a fifth") {
  Log log = make_five_hole_log();
  log["pt_pa"][2] = 900;
  log["pt_pa"][5] = 800;
  const auto prepared = prepare_five_hole(log.build());
  CHECK(prepared.flight_rows == std::vector<std::size_t>{0, 1, 3, 4, 6, 7, 8, 9});
  CHECK(column(prepared, "roll") == std::vector<double>{100, 101, 103, 104, 106, 107, 108, 109});
  REQUIRE(prepared.dropped.size() == 1);
  CHECK(prepared.dropped[0].reason == "pt is not above ps");
  CHECK(prepared.dropped[0].rows == 2);
  log["pt_pa"][7] = 0;
  CHECK(refuse(log.build())
            .starts_with("log: pt is not above ps in 3 of 10 rows, more than a "
                         "fifth (the first is log row 2)"));
}

TEST_CASE("a flight of which nothing is left") {
  Log log = make_five_hole_log();
  log["vn_mps"].assign(10, not_a_number);
  CHECK(
      refuse(log.build(), {.log = {.drop_invalid = true}}) ==
      "log row 0: column 'vn_mps' holds nan, not a finite number, and has none in any of 10 rows; "
      "map reads it from another column");
  for (std::size_t i = 0; i < 10; ++i) log["vn_mps"][i] = i < 5 ? 1.0 : not_a_number;
  log["rho_kgpm3"].assign(10, -1.2);
  CHECK(refuse(log.build()) ==
        "log row 5: column 'vn_mps' holds nan, not a finite number; drop_invalid drops such rows");
  log["vn_mps"].assign(10, 1.0);
  CHECK(refuse(log.build()) ==
        "log row 0: rho is not positive; none of 10 rows is without such a fault");
  for (auto& [name, values] : log.columns) values.clear();
  CHECK(refuse(log.build()) == "log: no row is left of 0: there was none");
}

TEST_CASE("maneuvers and gaps become segments of the rows that are left") {
  Log log = make_five_hole_log();
  for (std::size_t i = 7; i < 10; ++i) log["time_s"][i] += 1;
  log["pt_pa"][1] = 0;
  Flight flight = log.build();
  flight.label({"a", "a", "a", "b", "b", "b", "b", "b", "b", "c"});
  const auto prepared = prepare_five_hole(flight);
  const auto& segments = prepared.record.segments();
  REQUIRE(segments.size() == 4);
  CHECK((segments[0].label == "a" && segments[0].first == 0 && segments[0].last == 2));
  CHECK((segments[1].label == "b" && segments[1].first == 2 && segments[1].last == 6));
  CHECK((segments[2].label == "b" && segments[2].first == 6 && segments[2].last == 8));
  CHECK((segments[3].label == "c" && segments[3].first == 8 && segments[3].last == 9));
}

TEST_CASE("applying a five-hole calibration keeps every row and marks what can't be") {
  Log log = make_five_hole_log();
  log["pt_pa"][2] = 900;
  for (const char* header : {"time_s", "roll_rad", "vn_mps"}) log.erase(header);
  const auto readings = sepcal::read_five_hole(log.build());
  CHECK(readings.record.names() == std::vector<std::string>{"pt", "ps", "dpa", "dpb", "rho"});
  CHECK(readings.record.length() == 10);
  CHECK(std::ranges::count(readings.valid, true) == 9);
  CHECK_FALSE(readings.valid[2]);
  CHECK(mentions(readings.notes, "1 of 10 rows can't be calibrated: pt is not above ps"));
  // On the ground there may be many of these.
  log["pt_pa"].assign(10, 900);
  CHECK(std::ranges::count(sepcal::read_five_hole(log.build()).valid, true) == 0);
  log["dpa_pa"][7] = not_a_number;
  CHECK_THROWS_WITH_AS(sepcal::read_five_hole(log.build()), Contains("log row 7: column 'dpa_pa'"),
                       Error);
  CHECK(sepcal::read_five_hole(log.build(), {.drop_invalid = true}).dropped.size() == 2);
  log.erase("dpa_pa");
  CHECK_THROWS_WITH_AS(sepcal::read_five_hole(log.build()), Contains("'dpa_pa' is missing"), Error);
}

}  // namespace probe_columns_test
