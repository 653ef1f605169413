// SPDX-License-Identifier: BSD-3-Clause
// The simulator's flights as logs: the paper's timetable, what each maneuver excites, seeds, the
// CSV, and how misuse is refused.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>

#include "sepcal/error.hpp"
#include "simulated_flights.hpp"

namespace simulate_log_test {

namespace {

using namespace sepcal;
using namespace sepcal::test;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

std::string text_of(const SimulatedFlight& flight) {
  std::ostringstream out;
  write_csv(flight, out);
  return out.str();
}

/// Largest minus smallest value, over the rows with this label.
double span_of(const SimulatedFlight& flight, const char* name, const std::string& label) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t k = 0; k < flight.rows(); ++k) {
    if (flight.maneuver[k] != label) continue;
    low = std::min(low, flight.column(name)[k]);
    high = std::max(high, flight.column(name)[k]);
  }
  return high - low;
}

/// Simulates with a truth or options that `spoil` has altered: refused in one line, with the
/// culprit and the way out in it.
template <class Truth, class Spoil>
void check_refused(SimulatedFlight (*simulate)(const Truth&, const SimulationOptions&),
                   const Spoil& spoil, const std::string& culprit, const std::string& way_out) {
  Truth truth;
  SimulationOptions options = condensed(20);
  spoil(truth, options);
  CAPTURE(culprit);
  try {
    simulate(truth, options);
    FAIL_CHECK("nothing was thrown");
  } catch (const Error& error) {
    const std::string what = error.what();
    CAPTURE(what);
    CHECK(what.find(culprit) != std::string::npos);
    CHECK(what.find(way_out) != std::string::npos);
    CHECK(what.find('\n') == std::string::npos);
  }
}

}  // namespace

TEST_CASE("the same seed gives the same bytes, another seed other noise only") {
  const SimulatedFlight flight = simulate_five_hole({}, condensed(300, 7));
  const SimulatedFlight other = simulate_five_hole({}, condensed(300, 8));
  CHECK(text_of(flight) == text_of(simulate_five_hole({}, condensed(300, 7))));
  const std::set<std::string> noisy{"vn_mps", "ve_mps", "vd_mps"};
  for (const auto& column : flight.columns) {
    CAPTURE(column.name);
    CHECK((column.values != other.column(column.name)) == noisy.contains(column.name));
  }
  CHECK(text_of(simulate_magnetometer({}, condensed(300, 7))) ==
        text_of(simulate_magnetometer({}, condensed(300, 7))));
  CHECK(simulate_magnetometer({}, condensed(300, 7)).column("mx_ut") !=
        simulate_magnetometer({}, condensed(300, 8)).column("mx_ut"));
}

TEST_CASE("the full flight keeps the timetable of Table 5") {
  const SimulatedFlight flight = simulate_five_hole();
  const auto& time = flight.column("time_s");
  REQUIRE(flight.rows() == 37001);  // 740 s at 50 Hz, both ends
  CHECK(time.front() == 380.0);
  CHECK(time[1] == 380.02);
  CHECK(time.back() == 1120.0);
  std::map<std::string, std::pair<double, double>> seen;
  for (std::size_t k = 0; k < flight.rows(); ++k) {
    seen.try_emplace(flight.maneuver[k], time[k], time[k]).first->second.second = time[k];
  }
  seen.erase("cruise");
  // The yaw chirp's end, 1013.595 s, lies between two rows.
  const std::map<std::string, std::pair<double, double>> table{
      {"wind_circle_1", {384, 408.2}},  {"wind_circle_2", {411, 438.3}},
      {"popu", {510.9, 530}},           {"multisine_1", {576, 596}},
      {"multisine_2", {690, 711}},      {"multisine_3", {752, 772}},
      {"multisine_4", {810, 830}},      {"pitch_chirp_1", {867, 887}},
      {"yaw_chirp", {980.08, 1013.58}}, {"pitch_chirp_2", {1041, 1061}},
      {"rudder_doublet", {1113, 1115}}};
  CHECK(seen == table);
}

TEST_CASE("each maneuver excites what it is flown for, in the full and the condensed flight") {
  for (const std::size_t rows : {std::size_t{0}, std::size_t{400}}) {
    CAPTURE(rows);
    const SimulatedFlight flight = simulate_five_hole({}, condensed(rows));
    CHECK(flight.rows() == (rows == 0 ? 37001 : rows));
    for (const char* circle : {"wind_circle_1", "wind_circle_2"}) {
      std::set<int> octants;
      for (std::size_t k = 0; k < flight.rows(); ++k) {
        if (flight.maneuver[k] != circle) continue;
        octants.insert(static_cast<int>(std::floor(flight.column("yaw_rad")[k] / 0.7853981634)));
      }
      CHECK(octants.size() >= 8);
      CHECK(span_of(flight, "roll_rad", circle) > 0.3);
    }
    CHECK(span_of(flight, "pitch_rad", "popu") > 0.25);
    CHECK(span_of(flight, "p_radps", "multisine_1") > 0.5);
    CHECK(span_of(flight, "q_radps", "multisine_1") > 0.3);
    CHECK(span_of(flight, "r_radps", "multisine_1") > 0.3);
    CHECK(span_of(flight, "q_radps", "pitch_chirp_1") > 0.5);
    CHECK(span_of(flight, "r_radps", "yaw_chirp") > 0.5);
    CHECK(span_of(flight, "dpb_pa", "rudder_doublet") > 100.0);
    double slowest = 1e9, fastest = 0;
    for (std::size_t k = 0; k < flight.rows(); ++k) {
      const double impact = flight.column("pt_pa")[k] - flight.column("ps_pa")[k];
      REQUIRE(impact > 0);
      const double speed = std::sqrt(2 * impact / flight.column("rho_kgpm3")[k]);
      slowest = std::min(slowest, speed);
      fastest = std::max(fastest, speed);
    }
    CHECK(slowest > 10);
    CHECK(fastest < 25);
    CHECK(fastest - slowest > 6);
  }
}

TEST_CASE("the CSV has the columns of the interface and loses no bit") {
  const SimulatedFlight flight = simulate_five_hole({}, condensed(250, 3));
  std::istringstream lines(text_of(flight));
  std::string line;
  std::getline(lines, line);
  CHECK(line ==
        "time_s,roll_rad,pitch_rad,yaw_rad,p_radps,q_radps,r_radps,vn_mps,ve_mps,vd_mps,pt_pa,"
        "ps_pa,dpa_pa,dpb_pa,temp_k,rho_kgpm3,altitude_m,throttle,current_a,flap,maneuver");
  std::size_t row = 0;
  for (; std::getline(lines, line); ++row) {
    std::istringstream cells(line);
    std::string cell;
    for (const auto& column : flight.columns) {
      std::getline(cells, cell, ',');
      REQUIRE(std::strtod(cell.c_str(), nullptr) == column.values[row]);
    }
    std::getline(cells, cell);
    REQUIRE(cell == flight.maneuver[row]);
  }
  CHECK(row == 250);

  const std::string magnetometer = text_of(simulate_magnetometer({}, condensed(2)));
  CHECK(magnetometer.substr(0, magnetometer.find('\n')) ==
        "time_s,mx_ut,my_ut,mz_ut,roll_rad,pitch_rad,yaw_rad,p_radps,q_radps,r_radps,bn_ut,be_ut,"
        "bd_ut,temp_degc,current_a,throttle,voltage_v,panel_current_a,maneuver");
  const std::string tube = text_of(simulate_pitot_static({}, condensed(2)));
  CHECK(tube.substr(0, tube.find('\n')) ==
        "time_s,roll_rad,pitch_rad,yaw_rad,p_radps,q_radps,r_radps,vn_mps,ve_mps,vd_mps,dp_pa,"
        "ps_pa,temp_k,rho_kgpm3,airspeed_mps,altitude_m,throttle,current_a,flap,maneuver");
}

TEST_CASE("a failing stream is left failed") {
  std::ostream nowhere(nullptr);
  write_csv(simulate_five_hole({}, condensed(5)), nowhere);
  CHECK(nowhere.fail());
}

TEST_CASE("misuse is refused in one line with the way out") {
  const auto fly = [](auto spoil, const char* culprit, const char* way_out) {
    check_refused(sepcal::simulate_five_hole, spoil, culprit, way_out);
  };
  fly([](auto& t, auto&) { t.parameters["lambda_v"] = 0; }, "'lambda_v' is unknown", "lambda_va");
  fly([](auto& t, auto&) { t.parameters.erase("w_e"); }, "'w_e' is missing", "w_n");
  fly([](auto& t, auto&) { t.parameters["b_va"] = not_a_number; }, "'b_va'", "finite");
  fly([](auto& t, auto&) { t.parameters["lambda_va"] = -1; }, "lambda_va = -1", "above -1");
  fly([](auto& t, auto&) { t.parameters["b_va"] = 40; }, "b_va = 40", "smaller");
  fly([](auto& t, auto&) { t.k_alpha = 0; }, "sensitivity 0 1/rad", "above 0");
  fly([](auto& t, auto&) { t.k_beta = not_a_number; }, "sensitivity nan 1/rad", "finite");
  fly([](auto& t, auto&) { t.noise[1] = -0.1; }, "velocity noise -0.1", "at least 0");
  fly([](auto& t, auto&) { t.lever_arm[2] = not_a_number; }, "lever arm nan", "finite");
  fly([](auto& t, auto&) { t.altitude = 12000; }, "12000 m", "11000 m");
  fly([](auto&, auto& o) { o.rate = 0; }, "rate: 0 Hz", "at most 10000");
  fly([](auto&, auto& o) { o.rate = not_a_number; }, "rate: nan Hz", "at most 10000");
  fly([](auto&, auto& o) { o.rows = 20'000'000; }, "20000000", "at most 10000000");

  const auto turn = [](auto spoil, const char* culprit, const char* way_out) {
    check_refused(simulate_magnetometer, spoil, culprit, way_out);
  };
  turn([](auto& t, auto&) { t.noise[0] = -1; }, "magnetometer noise -1", "at least 0");
  turn([](auto& t, auto&) { t.field[1] = not_a_number; }, "field nan", "finite");
  turn([](auto& t, auto&) { t.parameters["eta"] = 0; }, "'eta' is unknown", "eta_x");
}

TEST_CASE("a column that is not there is named, with those that are") {
  const SimulatedFlight flight = simulate_five_hole({}, condensed(2));
  CHECK_THROWS_WITH_AS(flight.column("vn"), doctest::Contains("'vn' is missing; it has: time_s, "),
                       Error);
}

}  // namespace simulate_log_test
