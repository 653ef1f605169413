// SPDX-License-Identifier: BSD-3-Clause
// What a check makes of motion, units and axes, of a log that no fit would take, and what a fit
// shows of it.
#include "sepcal/flight/check.hpp"

#include "checked_logs.hpp"
#include "flight/checks/excitation.hpp"
#include "sepcal/flight/calibration.hpp"

namespace check_test {

using namespace sepcal;
using namespace sepcal::test;
using doctest::Approx;

namespace {

/// The first note, which must be of that kind.
LogNote first(const FlightCheck& checked, const std::string& kind) {
  REQUIRE(!checked.notes.empty());
  CHECK(checked.notes.front().kind == kind);
  return checked.notes.front();
}

void scale(Log& log, const std::string& header, double factor) {
  for (double& value : log[header]) value *= factor;
}

void swap_columns(Log& log, const std::string& one, const std::string& other) {
  std::swap(log[one], log[other]);
}

}  // namespace

TEST_CASE("the arc and the part of the sphere that directions cover, against the closed forms") {
  CHECK(checks::covered_arc({}) == 0.0);
  CHECK(checks::covered_arc({0.0, pi / 2}) == Approx(pi / 2));
  CHECK(checks::covered_arc({-0.1, 2 * pi + 0.1}) == Approx(0.2));
  CHECK(checks::covered_arc({0.0, pi}) == Approx(pi));
  const Eigen::Matrix3Xd one = Eigen::Vector3d(0, 0, 7).replicate(1, 1000);
  const double reach = pi / 18;
  CHECK(checks::covered_sphere(one) == Approx(0.5 * (1 - std::cos(reach))).epsilon(0.2));
  Eigen::Matrix3Xd circle(3, 720);
  for (int i = 0; i < 720; ++i) {
    circle.col(i) << std::cos(pi * i / 360), std::sin(pi * i / 360), 0;
  }
  CHECK(checks::covered_sphere(circle) == Approx(std::sin(reach)).epsilon(0.02));
}

TEST_CASE("a log without a turn, without a range of airspeeds, with rows on the ground") {
  Log straight = tube_log();
  blur(straight["vn_mps"], 0.0, 0);
  std::vector<double> east(3000, 1.0);
  blur(east, 0.3, 5);
  straight["ve_mps"] = east;
  straight["yaw_rad"] = std::vector<double>(3000, 0.1);
  for (double& value : straight["vn_mps"]) value = std::abs(value) + 12;
  scale(straight, "vn_mps", 0.8);
  CHECK(contains(first(check_tube(straight), "headings").found, "of 360 degrees"));

  Log steady = tube_log();
  std::vector<double> speed(3000, 20.0);
  blur(speed, 0.1, 3);
  steady["airspeed_mps"] = speed;
  const LogNote note = first(check_tube(steady), "airspeeds");
  CHECK(contains(note.found, "19.8 to 20.2 m/s"));  // 20 +- 1.64 * 0.1

  Log ground = tube_log();
  for (const char* header : {"vn_mps", "ve_mps", "vd_mps", "airspeed_mps"}) {
    std::fill_n(ground[header].begin(), 500, 0.0);
    blur(ground[header], 0.05, 9);
  }
  const FlightCheck checked = check_tube(ground);
  REQUIRE(notes_of(checked, "at_rest").size() == 1);
  CHECK(notes_of(checked, "at_rest")[0].rows == 500);
  CHECK(contains(notes_of(checked, "at_rest")[0].advice, "--stage-one-segments 10:59.98"));
}

TEST_CASE("a speed in another unit than its header's is told with the unit") {
  // What stands under a header, and the header.
  struct Slip {
    const char* unit;
    double per_mps;
    const char* header;
  };
  for (const Slip& slip :
       {Slip{"mps", 1.0, "airspeed_kt"}, Slip{"kt", 3600 / 1852.0, "airspeed_mps"},
        Slip{"kmh", 3.6, "airspeed_mps"}, Slip{"mps", 1.0, "airspeed_kmh"},
        Slip{"kmh", 3.6, "airspeed_kt"}}) {
    Log log = tube_log();
    scale(log, "airspeed_mps", slip.per_mps);
    log.rename("airspeed_mps", slip.header);
    const FlightCheck checked = check_tube(log);
    const LogNote note = first(checked, "units");
    CHECK(note.concern == Concern::wrong);
    CHECK(
        contains(note.found, std::string("as ") + slip.unit + " under the header " + slip.header));
    CHECK(contains(note.advice, std::string("airspeed_") + slip.unit + "="));
    CHECK(checked.notes.size() == 1);
  }
}

TEST_CASE("a strong wind is no wrong unit") {
  Log log = tube_log();
  for (double& value : log["vn_mps"]) value += 5;  // 9.5 m/s in all, of an airspeed of 20
  CHECK(kinds(check_tube(log)) == "");
}

TEST_CASE("north and east that are swapped or of the wrong sign are told by the yaw") {
  Log swapped = tube_log();
  swap_columns(swapped, "vn_mps", "ve_mps");
  CHECK(contains(first(check_tube(swapped), "axes").found,
                 "with ve, vn in the place of vn, ve it would"));
  Log reversed = tube_log();
  scale(reversed, "ve_mps", -1);
  CHECK(contains(first(check_tube(reversed), "axes").found,
                 "with vn, -ve in the place of vn, ve it would"));
  CHECK(kinds(check_tube(reversed)) == "axes");
  Log radians = tube_log();
  radians.rename("yaw_rad", "yaw_deg");
  const LogNote note = first(check_tube(radians), "axes");
  CHECK(contains(note.found, "does not go where yaw_deg points"));
  CHECK(contains(note.advice, "check the unit and the sense of yaw_deg"));
}

TEST_CASE("a swap is told on a vehicle that hardly tilts, a wind across is none") {
  // Yaw alone: the field's vertical part, most of it, does not vary.
  Log level = sphere_log();
  for (std::size_t row = 0; row < 1500; ++row) {
    const double yaw = std::sin(0.01 * static_cast<double>(row));
    level["hx_ut"][row] = 20 * std::cos(yaw);
    level["hy_ut"][row] = -20 * std::sin(yaw);
    level["hz_ut"][row] = 45 + std::sin(0.3 * static_cast<double>(row));
    for (const char axis : {'x', 'y', 'z'}) {
      level[std::string("m") + axis + "_ut"][row] = level[std::string("h") + axis + "_ut"][row];
    }
  }
  for (const char* header : {"mx_ut", "my_ut", "mz_ut"}) blur(level[header], 0.2, 3);
  CHECK(kinds(check_sphere(level)) == "sphere");
  swap_columns(level, "mx_ut", "my_ut");
  CHECK(contains(first(check_sphere(level), "axes").found, "(my, mx, mz)"));

  Log drift = tube_log();  // one heading, and a track 40 degrees off it
  for (std::size_t row = 0; row < 3000; ++row) {
    drift["vn_mps"][row] = drift["airspeed_mps"][row] * std::cos(1.2);
    drift["ve_mps"][row] = drift["airspeed_mps"][row] * std::sin(1.2);
    drift["yaw_rad"][row] = 0.5 + 0.001 * drift["pitch_rad"][row];
  }
  CHECK(notes_of(check_tube(drift), "axes").empty());
}

TEST_CASE("the axes of a magnetometer, its strength, and the part of the sphere") {
  Log swapped = sphere_log();
  swap_columns(swapped, "mx_ut", "my_ut");
  scale(swapped, "mz_ut", -1);
  const FlightCheck checked = check_sphere(swapped);
  CHECK(kinds(checked) == "axes");
  CHECK(contains(first(checked, "axes").found, "(my, mx, -mz)"));

  Log nano = sphere_log();
  for (const char* header : {"mx", "my", "mz"}) {
    scale(nano, std::string(header) + "_ut", 0.01);  // gauss
    nano.rename(std::string(header) + "_ut", std::string(header) + "_nt");
  }
  const LogNote note = first(check_sphere(nano), "units");
  CHECK(contains(note.found, ": as gauss under the header mx_nt would be"));
  CHECK(contains(note.advice, "mx_gauss"));

  Log part = sphere_log();
  for (auto& [header, values] : part.columns) values.resize(300);  // z from 1 to 0.6
  const FlightCheck seen = check_sphere(part);
  CHECK(kinds(seen) == "sphere");
  CHECK(contains(seen.notes[0].found, "by the attitude"));
  Log alone = part;
  for (const char* header : {"hx_ut", "hy_ut", "hz_ut"}) alone.erase(header);
  const FlightCheck blind = check(*attitude_independent_probe(50.0), alone.build());
  CHECK(kinds(blind) == "sphere");
  CHECK(contains(blind.notes[0].found, "by the readings about their middle"));
  Log whole = sphere_log();
  CHECK(kinds(check(*attitude_independent_probe(50.0), whole.build())) == "");
}

TEST_CASE("readings that no flight has are told as by a fit, each once") {
  Log log = tube_log();
  scale(log, "yaw_rad", 180 / pi);
  const FlightCheck checked = check_tube(log);
  const auto notes = notes_of(checked, "implausible");
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].columns == std::vector<std::string>{"yaw_rad"});
  CHECK(contains(notes[0].advice, "if it is in deg"));
}

TEST_CASE("what a fit would refuse is described all the same, and what is missing named") {
  Log log = tube_log();
  log.erase("ve_mps").erase("vd_mps");
  log["airspeed_mps"][7] = std::nan("");
  const FlightCheck checked = check_tube(log);
  CHECK(contains(checked.refused, "column 've_mps' is missing"));
  CHECK(contains(checked.refused, "missing too: vd_mps"));
  CHECK(checked.columns.size() == 6);
  CHECK(checked.columns[2].missing == 1);
  CHECK(checked.columns[2].quantity == "airspeed");
  CHECK(checked.columns[2].median == Approx(20).epsilon(0.01));
  CHECK(contains(to_text(checked), "a fit would refuse it"));
  Flight empty("nothing");
  CHECK(contains(check(*pitot_static_probe(), empty).refused, "is missing"));
}

TEST_CASE("a fit shows what matters, six lines and how many more there are") {
  FlightCheck checked{.model = "pitot-static",
                      .app = "sepcal-pitot",
                      .file = "a.csv",
                      .sha256 = "sha",
                      .rows = 10,
                      .rows_used = 10};
  for (int k = 0; k < 8; ++k) {
    checked.notes.push_back({.kind = "held",
                             .concern = Concern::matters,
                             .found = "found " + std::to_string(k),
                             .effect = "so",
                             .advice = "do"});
  }
  checked.notes.push_back({.kind = "gaps", .concern = Concern::slight});
  const auto lines = brief_notes(checked);
  REQUIRE(lines.size() == 7);
  CHECK(lines[0] == "a.csv: found 0; so; do");
  CHECK(lines[6] == "2 more: sepcal-pitot check a.csv");
  checked.notes.erase(checked.notes.begin(), checked.notes.begin() + 8);
  CHECK(brief_notes(checked).empty());
}

TEST_CASE("a fit notes what the check found") {
  Log log = tube_log(600);
  scale(log, "airspeed_mps", 1.0);
  log.rename("airspeed_mps", "airspeed_kt");
  const Calibration calibration = calibrate(pitot_static_probe(), log.build());
  CHECK(mentions(calibration.notes, "as mps under the header airspeed_kt"));
}

}  // namespace check_test
