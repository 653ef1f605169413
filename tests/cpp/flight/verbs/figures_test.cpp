// SPDX-License-Identifier: BSD-3-Clause
// What pictures are drawn from, on flights whose rows, gaps and labels are made by hand.
#include "flight/verbs/figures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "flights_with_effects.hpp"
#include "sepcal/flight/comparison.hpp"

namespace figures_test {

using namespace sepcal;
using namespace sepcal::test;

namespace {

std::vector<double>& column(SimulatedFlight& flight, std::string_view name) {
  return std::ranges::find(flight.columns, name, &SimulatedColumn::name)->values;
}

/// Twenty rows of an exact flight, 1 s apart, 50 s more before row 10.
SimulatedFlight make_flight_with_gap() {
  SimulatedFlight flight = simulate_five_hole(quiet(FiveHoleTruth{}), condensed(20));
  auto& time = column(flight, "time_s");
  for (std::size_t row = 0; row < 20; ++row) {
    time[row] = static_cast<double>(row) + (row < 10 ? 0.0 : 50.0);
  }
  flight.maneuver.assign(5, "climb");
  flight.maneuver.resize(20, "turn");
  return flight;
}

Calibration make_truth() {
  Calibration truth = make_calibration(make_five_hole(), FiveHoleTruth{}.parameters);
  truth.fit.noise = {{"vn", 1.0}, {"ve", 1.0}, {"vd", 1.0}};
  return truth;
}

void check_segment(const Segment& segment, const char* label, std::size_t first, std::size_t last) {
  CHECK(segment.label == label);
  CHECK(segment.first == first);
  CHECK(segment.last == last);
}

}  // namespace

TEST_CASE("rows that are dropped leave the others' numbers, labels and gaps in place") {
  SimulatedFlight simulated = make_flight_with_gap();
  column(simulated, "pt_pa")[2] = not_a_number;
  Calibration truth = make_truth();
  truth.options.log.drop_invalid = true;
  const FlightFigures figures = gather_figures(truth, make_flight(simulated));
  REQUIRE(figures.rows.size() == 19);
  CHECK(figures.rows[1] == 1);
  CHECK(figures.rows[2] == 3);
  CHECK(figures.rows[18] == 19);
  REQUIRE(figures.segments.size() == 3);
  check_segment(figures.segments[0], "climb", 0, 4);
  check_segment(figures.segments[1], "turn", 4, 9);
  check_segment(figures.segments[2], "turn", 9, 19);
  REQUIRE(figures.runs.size() == 2);
  check_segment(figures.runs[0], "", 0, 9);
  check_segment(figures.runs[1], "", 9, 19);
  CHECK(figures.interval[1] == 1.0);
  CHECK(figures.interval[2] == doctest::Approx(1.3));  // 16 of 1 s, one of 2 s, one of 51 s
}

TEST_CASE("measured is the log's, modelled what the residual leaves of it") {
  SimulatedFlight simulated = make_flight_with_gap();
  column(simulated, "vn_mps")[7] += 2.5;  // one row of twenty beyond 1.96 deviations
  const Flight flight = make_flight(simulated);
  const FlightFigures figures = gather_figures(make_truth(), flight);
  const Comparison compared = compare(make_truth(), flight);
  REQUIRE(figures.measured.rows() == 20);
  for (Eigen::Index row = 0; row < 20; ++row) {
    CHECK(figures.measured(row, 1) == column(simulated, "ve_mps")[static_cast<std::size_t>(row)]);
  }
  CHECK((figures.measured - figures.modelled - compared.residuals).cwiseAbs().maxCoeff() < 1e-12);
  CHECK(figures.within_95[0] == doctest::Approx(0.95));
  CHECK(figures.within_95[1] == 1.0);
}

TEST_CASE("airspeed, heading and channels as they were read") {
  SimulatedFlight simulated = make_flight_with_gap();
  column(simulated, "yaw_rad")[3] = -0.5;
  column(simulated, "yaw_rad")[4] = 7.0;
  const FlightFigures figures = gather_figures(make_truth(), make_flight(simulated));
  CHECK_FALSE(figures.heading_is_track);
  CHECK(figures.heading[3] == doctest::Approx(2 * std::numbers::pi - 0.5));
  CHECK(figures.heading[4] == doctest::Approx(7.0 - 2 * std::numbers::pi));
  const double pressure = column(simulated, "pt_pa")[6] - column(simulated, "ps_pa")[6];
  const double rho = figures.channels.column("rho")[6];
  CHECK(figures.airspeed[6] == doctest::Approx(std::sqrt(2 * pressure / rho)));
  CHECK(figures.channels.column("alpha").size() == 20);
}

TEST_CASE("a flight without an attitude shows its track over ground") {
  Flight flight("flight");
  flight.add("time_s", {0, 1, 2, 3}).add("airspeed_mps", {20, 21, 22, 23});
  flight.add("vn_kmh", {36, 0, -36, 0}).add("ve_kmh", {0, 36, 0, -36}).add("vd_mps", {0, 0, 0, 0});
  Calibration tube = make_calibration(pitot_static_probe(), PitotStaticTruth{}.parameters);
  const FlightFigures figures = gather_figures(tube, flight);
  CHECK(figures.heading_is_track);
  for (std::size_t row = 0; row < 4; ++row) {
    CHECK(figures.heading[row] == doctest::Approx(static_cast<double>(row) * std::numbers::pi / 2));
  }
  CHECK(figures.airspeed == std::vector<double>{20, 21, 22, 23});
  CHECK(figures.measured(2, 0) == 22.0);
  CHECK(figures.channels.column("vn")[2] == doctest::Approx(-10.0));
}

TEST_CASE("where only a field's strength is known it stands beside that of the calibrated field") {
  const SimulatedFlight simulated = fly("magnetometer-norm", {}, {.noise = 0.1});
  const Calibration calibration = calibrate_with("magnetometer-norm", simulated, {});
  const Flight flight = make_flight(simulated);
  const FlightFigures figures = gather_figures(calibration, flight);
  const Comparison compared = compare(calibration, flight);
  CHECK((figures.modelled.array() == field_strength()).all());
  CHECK((figures.modelled - figures.measured - compared.residuals).cwiseAbs().maxCoeff() < 1e-10);
  CHECK(figures.airspeed.empty());
}

}  // namespace figures_test
