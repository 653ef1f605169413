// SPDX-License-Identifier: BSD-3-Clause
// Logs as they come: foreign headers, clocks that start anew, attitude as a quaternion.
#include "sepcal/detail/flight/read_as.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "draws.hpp"
#include "flight/logs/smoothed_track.hpp"
#include "sepcal/error.hpp"

namespace read_as_test {

using doctest::Approx;
using doctest::Contains;
using sepcal::Error;
using sepcal::Flight;
using sepcal::LogChoice;
using sepcal::read_as;
using sepcal::ReadFlight;

namespace {

std::vector<double> values(const Flight& flight, std::string_view header) {
  REQUIRE(flight.find(header) != nullptr);
  const auto column = flight.find(header)->values;
  return {column.begin(), column.end()};
}

std::vector<double> ramp(double first, double step, std::size_t count) {
  std::vector<double> column;
  for (std::size_t i = 0; i < count; ++i) column.push_back(first + step * static_cast<double>(i));
  return column;
}

}  // namespace

TEST_CASE("columns are read under other names, or are as if they were not there") {
  Flight log("log");
  log.add("Time", {0, 1}).add("TAS", {40, 41}).add("airspeed_kt", {9, 9}).add("junk", {0, 0});
  const LogChoice choice{.map = {{"airspeed_kt", "TAS"}, {"time_s", "Time"}},
                         .ignore = {"airspeed_kt", "junk"}};
  const Flight read = read_as(log, choice).flight;
  CHECK(read.columns().size() == 2);
  CHECK(values(read, "airspeed_kt") == std::vector<double>{40, 41});
  CHECK(values(read, "time_s") == std::vector<double>{0, 1});
  CHECK(log.columns().size() == 4);  // stays as it was
}

TEST_CASE("headers that clearly are a quantity in a unit are taken, with one note") {
  Flight log("log");
  log.add("Time [s]", {0, 1}).add("GPS_VN (m/s)", {1, 2}).add("Mag X [nT]", {3, 4});
  log.add("Roll_Deg", {5, 6}).add("GPS Velocity E (m/s)", {7, 8}).add("GndSpd kt", {9, 9});
  log.add("Volts", {12, 12});
  const ReadFlight read = read_as(log, {});
  CHECK(values(read.flight, "vn_mps") == std::vector<double>{1, 2});
  CHECK(values(read.flight, "mx_nt") == std::vector<double>{3, 4});
  CHECK(values(read.flight, "roll_deg") == std::vector<double>{5, 6});
  CHECK(values(read.flight, "ve_mps") == std::vector<double>{7, 8});
  CHECK(values(read.flight, "gs_kt") == std::vector<double>{9, 9});
  CHECK(values(read.flight, "Volts") == std::vector<double>{12, 12});
  CHECK(read.flight.find("GPS_VN (m/s)") == read.flight.find("vn_mps"));  // by its own name too
  CHECK(read.notes ==
        std::vector<std::string>{
            "log: columns are read as time_s from 'Time [s]', roll_deg from 'Roll_Deg', vn_mps "
            "from 'GPS_VN (m/s)', ve_mps from 'GPS Velocity E (m/s)', gs_kt from 'GndSpd kt', "
            "mx_nt from 'Mag X [nT]'"});
}

TEST_CASE("what is there by its name, or could be two columns, is not taken") {
  Flight log("log");
  log.add("vn_mps", {0, 1}).add("GPS_VN (m/s)", {1, 2}).add("rol_deg", {3, 4});
  log.add("North velocity (m/s)", {5, 6}).add("ve (m/s)", {1, 1}).add("VE [kt]", {2, 2});
  log.add("Setpoint Yaw (deg)", {0, 0}).add("IMU temp (degC)", {40, 40}).add("Pitch", {1, 1});
  const ReadFlight read = read_as(log, {});
  CHECK(read.notes.empty());
  for (std::size_t i = 0; i < log.columns().size(); ++i) {
    CHECK(read.flight.columns()[i].header == log.columns()[i].header);
  }
}

TEST_CASE("a true airspeed comes before an indicated one") {
  Flight log("log");
  log.add("IAS (kt)", {1, 2}).add("TAS (kt)", {3, 4});
  const ReadFlight both = read_as(log, {});
  CHECK(values(both.flight, "airspeed_kt") == std::vector<double>{3, 4});
  CHECK(both.notes.front() ==
        "log: columns are read as airspeed_kt from 'TAS (kt)' (not 'IAS (kt)')");
  log.drop("TAS (kt)");
  CHECK(read_as(log, {}).notes.front() ==
        "log: columns are read as airspeed_kt from 'IAS (kt)' (for the air at sea level: its scale "
        "grows with height)");
}

TEST_CASE("an option may name a column as the log does, though it is read otherwise") {
  Flight log("log");
  log.add("IAS (kt)", {1, 2}).add("TAS (kt)", {3, 4});
  const ReadFlight read = read_as(log, {.map = {{"airspeed_kt", "IAS (kt)"}}});
  CHECK(values(read.flight, "airspeed_kt") == std::vector<double>{1, 2});
  CHECK(read.notes.empty());
  CHECK(read.flight.find("airspeed_kt")->logged == "IAS (kt)");
  CHECK(values(read_as(log, {.ignore = {"TAS (kt)"}}).flight, "airspeed_kt") ==
        std::vector<double>{1, 2});
}

TEST_CASE("two columns may change places, and a minus turns the sign") {
  Flight log("log");
  log.add("vn_mps", {1, 2}).add("ve_mps", {3, 4}).add("dpb_pa", {5, 6}).add("Mag Y [uT]", {7, 8});
  const ReadFlight read = read_as(log, {.map = {{"vn_mps", "ve_mps"},
                                                {"ve_mps", "vn_mps"},
                                                {"dpb_pa", "-dpb_pa"},
                                                {"mx_ut", "-Mag Y [uT]"}}});
  CHECK(values(read.flight, "vn_mps") == std::vector<double>{3, 4});
  CHECK(values(read.flight, "ve_mps") == std::vector<double>{1, 2});
  CHECK(values(read.flight, "dpb_pa") == std::vector<double>{-5, -6});
  CHECK(values(read.flight, "mx_ut") == std::vector<double>{-7, -8});
  CHECK(read.flight.find("Mag Y [uT]") == read.flight.find("mx_ut"));
  CHECK(values(log, "dpb_pa") == std::vector<double>{5, 6});  // stays as it was
}

TEST_CASE("a map that mirrors a sensor's axes is noted, and one that turns them is not") {
  Flight log("log");
  log.add("mx_ut", {1}).add("my_ut", {2}).add("mz_ut", {3});
  const auto notes = [&](std::map<std::string, std::string> map) {
    return read_as(log, {.map = std::move(map)}).notes;
  };
  CHECK(notes({{"mx_ut", "-my_ut"}, {"my_ut", "mx_ut"}}).empty());
  CHECK(notes({{"mx_ut", "my_ut"}, {"my_ut", "mz_ut"}, {"mz_ut", "mx_ut"}}).empty());
  for (const auto& mirrors : {std::map<std::string, std::string>{{"mz_ut", "-mz_ut"}},
                              {{"mx_ut", "my_ut"}, {"my_ut", "mx_ut"}}}) {
    CHECK(notes(mirrors) ==
          std::vector<std::string>{"log: map mirrors mx, my, mz: right for a sensor whose axes are "
                                   "a left-handed set, and no rotation"});
  }
}

TEST_CASE("a new name that is a letter away from one that is read is pointed out") {
  Flight log("log");
  log.add("TAS", {40, 41}).add("Thr", {0.4, 0.5});
  const ReadFlight read =
      read_as(log, {.map = {{"airsped_kt", "TAS"}, {"throttle_position", "Thr"}}});
  CHECK(read.notes == std::vector<std::string>{
                          "log: map airsped_kt=TAS reads the column as a channel of that name and "
                          "as no quantity; did you mean airspeed_kt?"});
}

TEST_CASE("velocity from speed, track and vertical speed") {
  Flight log("log");
  log.add("gs_kmh", {36, 72, 0}).add("track_deg", {90, 180, std::nan("")});
  log.add("vs_mps", {1, -2, 0});
  const ReadFlight read = read_as(log, {});
  const auto north = values(read.flight, "vn_mps");
  const auto east = values(read.flight, "ve_mps");
  CHECK(north[0] == Approx(0.0));
  CHECK(east[0] == Approx(10.0));
  CHECK(north[1] == Approx(-20.0));
  CHECK(east[1] == Approx(0.0));
  CHECK(north[2] == 0.0);  // at a standstill there is no track
  CHECK(values(read.flight, "vd_mps") == std::vector<double>{-1, 2, 0});
  CHECK(read.notes.back() == "log: vn and ve are from gs_kmh and track_deg, taken from true north");
}

TEST_CASE("a magnetic track is turned by the variation, and not used without it") {
  Flight log("log");
  log.add("gs_mps", {10, 10}).add("Magnetic Track (deg)", {80, 350}).add("vd_mps", {0, 0});
  CHECK(read_as(log, {}).flight.find("vn_mps") == nullptr);
  log.add("magvar_deg", {10, 10});
  const Flight read = read_as(log, {}).flight;
  CHECK(values(read, "vn_mps")[0] == Approx(0.0));
  CHECK(values(read, "ve_mps")[0] == Approx(10.0));
  CHECK(values(read, "vn_mps")[1] == Approx(10.0));
}

TEST_CASE("where the positions go tells whether a track is magnetic") {
  std::vector<double> latitude;
  std::vector<double> longitude;
  for (std::size_t i = 0; i < 100; ++i) {  // to the true north-east, some 14 m a row
    latitude.push_back(1e-4 * static_cast<double>(i));
    longitude.push_back(1e-4 * static_cast<double>(i));
  }
  for (const double logged : {45.0, 35.0}) {
    Flight log("log");
    log.add("gs_mps", std::vector<double>(100, 10)).add("vd_mps", std::vector<double>(100, 0));
    log.add("track_deg", std::vector<double>(100, logged));
    log.add("magvar_deg", std::vector<double>(100, 10));
    log.add("lat_deg", latitude).add("lon_deg", longitude);
    const Flight read = read_as(log, {}).flight;
    CHECK(values(read, "vn_mps")[5] == Approx(10 / std::numbers::sqrt2));
    CHECK(values(read, "ve_mps")[5] == Approx(10 / std::numbers::sqrt2));
  }
}

TEST_CASE("without a vertical speed the altitude tells the climb, or flight is level") {
  Flight log("log");
  log.add("time_s", ramp(0, 0.5, 40)).add("gs_mps", std::vector<double>(40, 20));
  log.add("track_deg", std::vector<double>(40, 0));
  const ReadFlight level = read_as(log, {});
  CHECK(values(level.flight, "vd_mps") == std::vector<double>(40, 0));
  CHECK(level.notes.back() ==
        "log: neither a vertical speed nor an altitude is logged: flight is taken for level, vd "
        "for zero");
  log.add("altitude_m", ramp(100, 1.5, 40));  // 3 m/s
  for (const double down : values(read_as(log, {}).flight, "vd_mps")) {
    CHECK(down == Approx(-3).epsilon(1e-3));
  }
}

TEST_CASE("angles in another unit than the header's are pointed out") {
  Flight log("log");
  std::vector<double> track;
  for (std::size_t i = 0; i < 100; ++i)
    track.push_back(std::fmod(0.1 * static_cast<double>(i), 6.28));
  log.add("gs_mps", std::vector<double>(100, 20)).add("track_deg", track);
  log.add("vd_mps", std::vector<double>(100, 0));
  CHECK(read_as(log, {}).notes.front() ==
        "log: track_deg turns over at 6.28, as an angle in radians does: if so, --map "
        "track_rad=track_deg reads it so");
  CHECK(read_as(log, {.map = {{"track_rad", "track_deg"}}}).notes.size() == 1);
}

TEST_CASE("time from the GPS's week and time of week") {
  Flight log("log");
  log.add("GWk", {2200, 2200, 2201}).add("GMS", {604799000, 604799500, 0});
  const ReadFlight read = read_as(log, {});
  CHECK(values(read.flight, "time_s") == std::vector<double>{604799, 604799.5, 604800});
  CHECK(read.notes == std::vector<std::string>{"log: time is GMS and GWk, in seconds"});
  Flight without_week("log");
  without_week.add("gps_tow_s", {604799, 0.5});
  CHECK(values(read_as(without_week, {}).flight, "time_s") ==
        std::vector<double>{604799, 604800.5});
}

TEST_CASE("of total, static and impact pressure the missing one") {
  Flight tube("log");
  tube.add("pt_hpa", {1010}).add("ps_pa", {100000});
  const ReadFlight read = read_as(tube, {});
  CHECK(values(read.flight, "dp_pa")[0] == Approx(1000));
  CHECK(read.notes == std::vector<std::string>{"log: dp is pt_hpa - ps_pa"});
  Flight five_hole("log");
  five_hole.add("dp_pa", {1000}).add("ps_pa", {100000}).add("dpa_pa", {1});
  CHECK(values(read_as(five_hole, {}).flight, "pt_pa")[0] == 101000);
}

TEST_CASE("a choice of columns that can't be is refused") {
  Flight log("log");
  log.add("TAS", {40, 41}).add("airspeed_kt", {9, 9});
  CHECK_THROWS_WITH_AS(read_as(log, {.map = {{"airspeed_kt", "IAS"}}}),
                       "log: map airspeed_kt=IAS names a column that is not there; the flight has: "
                       "TAS, airspeed_kt",
                       Error);
  CHECK_THROWS_WITH_AS(read_as(log, {.map = {{"airspeed_kt", "TAS"}}}),
                       Contains("there is a column 'airspeed_kt' already; ignore airspeed_kt"),
                       Error);
  CHECK_THROWS_WITH_AS(read_as(log, {.ignore = {"IAS"}}), Contains("ignore names IAS"), Error);
  CHECK_THROWS_WITH_AS(read_as(log, {.map = {{"maneuver", "TAS"}}}),
                       Contains("call that column maneuver"), Error);
}

TEST_CASE("a clock that starts anew goes on behind a gap; one that is out of order stays") {
  std::vector<double> time = ramp(100, 20, 30);  // ms, to 680
  std::ranges::copy(ramp(0, 20, 20), std::back_inserter(time));
  Flight log("log");
  log.add("time_ms", time);
  const ReadFlight read = read_as(log, {});
  const auto joined = values(read.flight, "time_ms");
  CHECK(joined[29] == 680);
  CHECK(joined[30] == 680 + 1000);
  CHECK(joined.back() == 680 + 1000 + 19 * 20);
  REQUIRE(read.notes.size() == 1);
  CHECK(read.notes[0] ==
        "log: time_ms runs back once, first at log row 30: taken for two logs that were joined, "
        "each with a clock of its own; each follows the one before after 1 s");

  time[5] = 0;
  Flight shuffled("log");
  shuffled.add("time_ms", time);
  CHECK(values(read_as(shuffled, {}).flight, "time_ms") == time);
}

TEST_CASE("a quaternion is the attitude of Eigen's rotation, whatever its length") {
  Flight log("log");
  const std::vector<Eigen::Vector3d> attitudes{
      {0.1, -0.4, 2.0}, {-2.5, 0.7, -3.0}, {0.0, 0.0, 0.0}, {1.0, 1.2, 0.5}};
  std::vector<std::vector<double>> q(4);
  for (const Eigen::Vector3d& euler : attitudes) {
    const Eigen::Quaterniond rotation(Eigen::AngleAxisd(euler[2], Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(euler[1], Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(euler[0], Eigen::Vector3d::UnitX()));
    const double length = 1.0 + euler[0];
    q[0].push_back(length * rotation.w());
    q[1].push_back(length * rotation.x());
    q[2].push_back(length * rotation.y());
    q[3].push_back(length * rotation.z());
  }
  for (auto& part : q) part.push_back(0.0);  // none at all
  log.add("qw", q[0]).add("qx", q[1]).add("qy", q[2]).add("qz", q[3]);
  const ReadFlight read = read_as(log, {});
  CHECK(read.flight.columns().size() == 3);
  for (std::size_t row = 0; row < attitudes.size(); ++row) {
    CHECK(values(read.flight, "roll_rad")[row] == Approx(attitudes[row][0]).epsilon(1e-12));
    CHECK(values(read.flight, "pitch_rad")[row] == Approx(attitudes[row][1]).epsilon(1e-12));
    CHECK(values(read.flight, "yaw_rad")[row] == Approx(attitudes[row][2]).epsilon(1e-12));
  }
  CHECK(std::isnan(values(read.flight, "roll_rad").back()));
  CHECK(read.notes.size() == 1);
  log.add("roll_deg", std::vector<double>(5, 0.0));
  CHECK(read_as(log, {}).flight.columns().size() == 5);  // angles are there already
}

/// A circle of 300 m in 60 s, climbing at 2 m/s, from a place on the ellipsoid.
struct Circle {
  double t = 0.0;
  double rate = 2.0 * std::numbers::pi / 60.0;

  double north() const { return 300.0 * std::sin(rate * t); }
  double east() const { return 300.0 * (1.0 - std::cos(rate * t)); }
  double vn() const { return 300.0 * rate * std::cos(rate * t); }
  double ve() const { return 300.0 * rate * std::sin(rate * t); }
};

TEST_CASE("velocity is that of the path whose positions were logged, across the date line too") {
  // Radii of WGS 84 at 60 deg, from tables: 6383.454 km along the meridian, 6394.209 km across.
  constexpr double meridian = 6'383'454.0 + 500.0;
  constexpr double across = 6'394'209.0 + 500.0;
  for (const double longitude : {10.0, 179.999}) {
    Flight log("log");
    std::vector<double> time;
    std::vector<double> lat;
    std::vector<double> lon;
    std::vector<double> altitude;
    for (int row = 0; row < 1200; ++row) {
      const Circle at{.t = 0.1 * row};
      time.push_back(at.t);
      lat.push_back(60.0 + at.north() / meridian * 180.0 / std::numbers::pi);
      const double east = longitude + at.east() / (across * 0.5) * 180.0 / std::numbers::pi;
      lon.push_back(east > 180.0 ? east - 360.0 : east);
      altitude.push_back(500.0 + 2.0 * at.t);
    }
    log.add("time_s", time).add("lat_deg", lat).add("lon_deg", lon).add("altitude_m", altitude);
    const ReadFlight read = read_as(log, {});
    REQUIRE(read.notes.size() == 1);
    CHECK(read.notes[0].find("velocity is from 1200 fixes") != std::string::npos);
    const auto vn = values(read.flight, "vn_mps");
    const auto ve = values(read.flight, "ve_mps");
    const auto vd = values(read.flight, "vd_mps");
    for (std::size_t row = 20; row < 1180; ++row) {
      const Circle at{.t = time[row]};
      CHECK(std::abs(vn[row] - at.vn()) < 0.03);  // the latitude changes the radii by 1e-4
      CHECK(std::abs(ve[row] - at.ve()) < 0.03);
      CHECK(std::abs(vd[row] + 2.0) < 1e-3);
    }
  }
}

TEST_CASE("a smoothed track is off by what it says, at any rate of fixes") {
  for (const double rate : {1.0, 10.0}) {
    for (const double size : {1.5, 0.05}) {
      sepcal::test::Draws draws(7);
      std::vector<double> time;
      std::vector<double> position;
      std::vector<double> truth;
      for (int i = 0; i < 600 * static_cast<int>(rate); ++i) {
        const Circle at{.t = i / rate};
        time.push_back(at.t);
        position.push_back(at.north() + size * draws.normal());
        truth.push_back(at.vn());
      }
      const auto track = sepcal::logs::smooth_track(time, position, {0, time.size()});
      double squares = 0.0;
      for (std::size_t i = 0; i < time.size(); ++i) {
        squares += (track.velocity[i] - truth[i]) * (track.velocity[i] - truth[i]);
      }
      const double error = std::sqrt(squares / static_cast<double>(time.size()));
      CHECK(track.position_error == Approx(size).epsilon(0.2));
      CHECK(error < 1.5 * track.velocity_error);
      CHECK(error > 0.4 * track.velocity_error);
    }
  }
}

TEST_CASE("a track that stands or moves evenly has that velocity") {
  const std::vector<double> time = ramp(0, 0.2, 100);
  const auto still = sepcal::logs::smooth_track(time, std::vector<double>(100, 4.0), {0, 100});
  const auto even = sepcal::logs::smooth_track(time, ramp(-5, 0.4, 100), {0, 50, 100});
  for (std::size_t i = 0; i < 100; ++i) {
    CHECK(std::abs(still.velocity[i]) < 1e-6);
    CHECK(even.velocity[i] == Approx(2.0).epsilon(1e-4));
  }
}

TEST_CASE("positions make no velocity where one is logged, and none across a gap") {
  std::vector<double> time = ramp(0, 1, 60);
  for (std::size_t row = 30; row < 60; ++row) time[row] += 100;
  Flight log("log");
  log.add("time_s", time).add("lat_deg", ramp(50, 1e-4, 60)).add("lon_deg", ramp(8, 1e-4, 60));
  log.add("altitude_m", std::vector<double>(60, 100.0));
  const auto vn = values(read_as(log, {}).flight, "vn_mps");
  CHECK(vn[29] == Approx(11.12).epsilon(0.01));
  CHECK(vn[30] == Approx(11.12).epsilon(0.01));
  log.add("vn_mps", std::vector<double>(60, 0.0));
  CHECK(read_as(log, {}).notes.empty());
}

}  // namespace read_as_test
