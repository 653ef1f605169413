// SPDX-License-Identifier: BSD-3-Clause
// Sensors of different rates: closed forms between samples, gaps, angles, clocks.
#include "sepcal/flight/joined_rates.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "draws.hpp"
#include "flight/logs/slow_column.hpp"
#include "flight/probes/joined_quantities.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/probe.hpp"

namespace joined_rates_test {

using doctest::Approx;
using doctest::Contains;
using sepcal::Error;
using sepcal::Flight;
using sepcal::join_rates;
using sepcal::logs::Joining;
using sepcal::logs::SlowColumn;

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// `f` at each time.
template <class F>
std::vector<double> at_each(const std::vector<double>& time, const F& f) {
  std::vector<double> values;
  for (const double t : time) values.push_back(f(t));
  return values;
}

std::vector<double> stamps(double first, double step, std::size_t count) {
  std::vector<double> time;
  for (std::size_t i = 0; i < count; ++i) time.push_back(first + step * static_cast<double>(i));
  return time;
}

std::vector<double> column(const Flight& flight, const std::string& header) {
  REQUIRE(flight.find(header) != nullptr);
  const auto values = flight.find(header)->values;
  return {values.begin(), values.end()};
}

/// In rows of its own each: airspeed at 10 Hz, velocity at 5 Hz between two of its rows.
Flight never_together() {
  Flight flight("log");
  std::vector<double> time;
  std::vector<double> airspeed;
  std::vector<double> vn;
  std::vector<double> zero;
  for (int i = 0; i < 400; ++i) {
    const double t = 0.05 * i;
    const bool fast = i % 2 == 1;
    const bool slow = i % 4 == 0;
    time.push_back(t);
    airspeed.push_back(fast ? 20.0 + t : none);
    vn.push_back(slow ? 15.0 + 2.0 * t : none);
    zero.push_back(slow ? 0.0 : none);
  }
  flight.add("time_s", time).add("airspeed_mps", airspeed);
  flight.add("vn_mps", vn).add("ve_mps", zero).add("vd_mps", zero);
  return flight;
}

}  // namespace

TEST_CASE("a line is met exactly between its samples, and by parabolas a parabola is") {
  const std::vector<double> time = stamps(3.0, 0.2, 60);
  const SlowColumn line(time, at_each(time, [](double t) { return 5.0 - 2.0 * t; }),
                        Joining::linear);
  const auto f = [](double t) { return 1.0 - 3.0 * t + 0.5 * t * t; };
  const SlowColumn parabola(time, at_each(time, f), Joining::smooth);
  for (double t = 3.0; t < 14.8; t += 0.037) {
    CHECK(line.at(t) == Approx(5.0 - 2.0 * t).epsilon(1e-12));
    CHECK(parabola.at(t) == Approx(f(t)).epsilon(1e-9));
  }
  CHECK(line.interval() == Approx(0.2));
  CHECK(line.at(time[7]) == 5.0 - 2.0 * time[7]);
}

TEST_CASE("a held value stays until the next sample") {
  const SlowColumn held(std::vector<double>{0.0, 1.0, 2.0}, std::vector<double>{4.0, 6.0, 5.0},
                        Joining::held);
  CHECK(held.at(0.0) == 4.0);
  CHECK(held.at(0.99) == 4.0);
  CHECK(held.at(1.0) == 6.0);
  CHECK(held.at(2.0) == 5.0);
}

TEST_CASE("nothing is extrapolated, and nothing crosses a gap of more than five intervals") {
  std::vector<double> time = stamps(0.0, 0.2, 30);                       // to 5.8
  for (const double t : stamps(7.0, 0.2, 30)) time.push_back(t);         // a gap of 1.2 s
  for (const double t : stamps(12.8 + 0.9, 0.2, 30)) time.push_back(t);  // four lost: 0.9 s is none
  const std::vector<double> ones(time.size(), 1.0);
  for (const Joining joining : {Joining::smooth, Joining::linear, Joining::held}) {
    const SlowColumn slow(time, ones, joining);
    CHECK(std::isnan(slow.at(-0.01)));
    CHECK(slow.at(5.8) == Approx(1.0));
    CHECK(std::isnan(slow.at(5.81)));
    CHECK(std::isnan(slow.at(6.99)));
    CHECK(slow.at(7.0) == Approx(1.0));
    CHECK(slow.at(13.0) == Approx(1.0));
    CHECK(std::isnan(slow.at(time.back() + 0.01)));
  }
}

TEST_CASE("angles go the short way round and stay within their turn") {
  const std::vector<double> time = stamps(0.0, 1.0, 40);
  const auto compass = [](double t) { return std::fmod(350.0 + 7.0 * t, 360.0); };
  const auto heading = [](double t) { return std::remainder(170.0 + 7.0 * t, 360.0); };
  for (const Joining joining : {Joining::smooth, Joining::linear}) {
    const SlowColumn to_360(time, at_each(time, compass), joining, 360.0);
    const SlowColumn to_180(time, at_each(time, heading), joining, 360.0);
    for (double t = 0.25; t < 39.0; t += 0.5) {
      CHECK(to_360.at(t) == Approx(compass(t)));
      CHECK(to_180.at(t) == Approx(heading(t)));
    }
  }
  CHECK(sepcal::logs::turn_of("track_deg") == Approx(360.0));
  CHECK(sepcal::logs::turn_of("altitude_m") == 0.0);
}

TEST_CASE("a parabola's noise is the same at its samples as between them; a line's is not") {
  sepcal::test::Draws draws(5);
  const std::vector<double> time = stamps(0.0, 0.2, 20000);
  const SlowColumn smooth(time, at_each(time, [&](double) { return draws.normal(); }),
                          Joining::smooth);
  const auto variance_at = [&](double shift) {
    double sum = 0.0;
    for (std::size_t i = 20; i < 19980; ++i) sum += std::pow(smooth.at(time[i] + shift), 2);
    return sum / 19960.0;
  };
  CHECK(variance_at(0.1) / variance_at(0.0) == Approx(1.0).epsilon(0.03));  // of a line: 0.5
}

TEST_CASE("columns of two logs stand in the rows of the measured sensor") {
  const std::vector<double> fast = stamps(100.0, 0.1, 100);        // to 109.9
  const std::vector<double> slow = stamps(101.03 - 7.0, 0.2, 30);  // to 106.83, 7 s behind
  Flight tube("tube.csv");
  tube.add("time_s", fast).add("airspeed_mps", at_each(fast, [](double t) { return t; }));
  tube.add("temp_k", std::vector<double>(100, 280.0));
  Flight receiver("gnss.csv");
  receiver.add("time_ms", at_each(slow, [](double t) { return 1000.0 * t; }));
  receiver.add("vn_mps", at_each(slow, [](double t) { return 3.0 * (t + 7.0); }));
  receiver.add("temp_k", std::vector<double>(30, 300.0));
  const Flight joined = join_rates(tube, receiver, {.how = "linear", .offset = 7.0});
  const auto time = column(joined, "time_s");
  const auto vn = column(joined, "vn_mps");
  CHECK(time.front() == Approx(101.1));  // the first row behind 101.03
  CHECK(time.back() == Approx(106.8));
  for (std::size_t i = 0; i < time.size(); ++i) {
    CHECK(vn[i] == Approx(3.0 * time[i]).epsilon(1e-9));
    CHECK(column(joined, "airspeed_mps")[i] == time[i]);
  }
  CHECK(column(joined, "temp_k").front() == 280.0);
  CHECK(joined.find("time_ms") == nullptr);
  REQUIRE(joined.notes().size() == 3);
  CHECK(joined.notes()[0] ==
        "tube.csv with gnss.csv: vn_mps (5 Hz) of gnss.csv are brought to the rows of tube.csv, on "
        "straight lines between their samples; 7 s are added to its clock");
  CHECK(joined.notes()[1] ==
        "tube.csv with gnss.csv: 42 of 100 rows of tube.csv are left out: gnss.csv has no samples "
        "on both sides of them");
  CHECK(joined.notes()[2] ==
        "tube.csv with gnss.csv: temp_k of tube.csv stay: gnss.csv has them too");
}

TEST_CASE("labels come from the log that has them") {
  Flight tube("tube");
  tube.add("time_s", {1, 2, 3}).add("airspeed_mps", {20, 20, 20});
  Flight receiver("gnss");
  receiver.add("time_s", {0, 2.5, 4}).add("vn_mps", {1, 1, 1}).label({"climb", "turn", "turn"});
  const Flight joined = join_rates(tube, receiver, {.how = "held"});
  const auto labels = joined.maneuvers();
  CHECK(std::vector<std::string>(labels.begin(), labels.end()) ==
        std::vector<std::string>{"climb", "climb", "turn"});
}

TEST_CASE("logs that can't be joined are refused with the way out") {
  Flight tube("tube");
  tube.add("time_s", {0, 1, 2}).add("airspeed_mps", {20, 20, 20});
  Flight receiver("gnss");
  receiver.add("time_s", {1000, 1001, 1002}).add("vn_mps", {1, 1, 1});
  CHECK_THROWS_WITH_AS(
      join_rates(tube, receiver),
      "tube lasts from 0 to 2 s and gnss from 1000 to 1002 s, which have no time in common; offset "
      "S adds S seconds to the second clock: -1000 lets both begin at once",
      sepcal::OptionError);
  CHECK(join_rates(tube, receiver, {.how = "linear", .offset = -1000}).rows() == 3);
  CHECK_THROWS_WITH_AS(join_rates(tube, receiver, {.how = "cubic"}),
                       "join is smooth, linear or held, not 'cubic'", sepcal::OptionError);
  CHECK_THROWS_WITH_AS(join_rates(tube, receiver, {.how = "held", .offset = none}),
                       Contains("offset is no finite number"), sepcal::OptionError);
  Flight timeless("timeless");
  timeless.add("vn_mps", {1, 1, 1});
  CHECK_THROWS_WITH_AS(join_rates(tube, timeless), Contains("timeless: there is no column of time"),
                       Error);
  Flight back("back");
  back.add("time_s", {1, 0, 2}).add("vn_mps", {1, 1, 1});
  CHECK_THROWS_WITH_AS(join_rates(tube, back), Contains("back row 1: time runs back"), Error);
}

TEST_CASE("of one log the rest is brought to the rows of what is measured") {
  const Flight log = never_together();
  const auto probe = sepcal::pitot_static_probe();
  for (const char* how : {"smooth", "linear"}) {
    const sepcal::LogChoice choice{.join = how};
    const auto read = sepcal::probes::read_for(*probe, log, choice);
    CHECK(read.flight.rows() == log.rows());
    REQUIRE(read.notes.size() == 1);
    CHECK(read.notes[0].find("vn_mps, ve_mps, vd_mps (5 Hz) are brought to the 200 rows of "
                             "airspeed_mps") != std::string::npos);
    const auto prepared = probe->prepare(read.flight, choice);
    const auto time = prepared.record.column("time");
    CHECK(time.size() == 198);  // behind the last sample of vn lie two rows
    for (std::size_t i = 0; i < time.size(); ++i) {
      CHECK(prepared.record.column("vn")[i] == Approx(15.0 + 2.0 * time[i]).epsilon(1e-9));
      CHECK(prepared.record.column("airspeed")[i] == 20.0 + time[i]);
    }
  }
}

TEST_CASE("rates that never share a row are refused with the option that joins them") {
  const Flight log = never_together();
  const auto probe = sepcal::pitot_static_probe();
  for (const bool drop : {false, true}) {
    CHECK_THROWS_WITH_AS(
        probe->prepare(log, {.drop_invalid = drop}),
        "log: none of 400 rows has all that is needed: vn_mps (in 100 rows), ve_mps (in 100 rows), "
        "vd_mps (in 100 rows), airspeed_mps (in 200 rows) were logged at different times; join "
        "smooth brings them to the rows of what is measured; linear and held do too",
        sepcal::OptionError);
  }
}

TEST_CASE("a single empty cell is no other rate") {
  Flight log("log");
  std::vector<double> vn(30, 15.0);
  vn[7] = none;
  log.add("time_s", stamps(0.0, 0.1, 30)).add("vn_mps", vn);
  log.add("ve_mps", std::vector<double>(30, 0.0)).add("vd_mps", std::vector<double>(30, 0.0));
  log.add("airspeed_mps", std::vector<double>(30, 20.0));
  CHECK_THROWS_WITH_AS(sepcal::pitot_static_probe()->prepare(log, {}),
                       Contains("column 'vn_mps' holds nan"), Error);
}

}  // namespace joined_rates_test
